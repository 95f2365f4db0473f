#include "alidade/io/files/yaml_check.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <sstream>
#include <vector>

#include "alidade/base/error.h"

namespace alidade {
namespace {

// Receives yaml-cpp's parser events; memory use is bounded by the nesting depth and the keys of
// open maps.
class Checker : public YAML::EventHandler {
 public:
  Checker(const std::string& name, int most_nodes) : name_(name), most_nodes_(most_nodes) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { Add(mark, nullptr); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { RefuseNames(mark); }
  void OnAnchor(const YAML::Mark& mark, const std::string&) override { RefuseNames(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& value) override {
    Add(mark, &value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    Open(mark, false);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    Open(mark, true);
  }
  void OnMapEnd() override { open_.pop_back(); }

  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& what) const {
    ThrowInput(name_ + ":" + std::to_string(mark.line + 1) + ": " + what);
  }

 private:
  struct Level {
    bool is_map;
    bool name_next = true;  // in a map, keys and values alternate
    std::set<std::string> names = {};
  };

  [[noreturn]] void RefuseNames(const YAML::Mark& mark) const {
    Fail(mark, "anchors and aliases (& and *) are not supported: write the value itself");
  }

  void Add(const YAML::Mark& mark, const std::string* text) {
    if (++nodes_ > most_nodes_)
      Fail(mark, "more than " + std::to_string(most_nodes_) +
                     " names and values: this is not a camera or settings file");
    if (open_.empty() || !open_.back().is_map) return;
    Level& map = open_.back();
    if (map.name_next && text != nullptr && !map.names.insert(*text).second)
      Fail(mark, "`" + text->substr(0, 60) + "` is given twice");
    map.name_next = !map.name_next;
  }

  void Open(const YAML::Mark& mark, bool is_map) {
    Add(mark, nullptr);
    if (open_.size() == static_cast<size_t>(kMostYamlDepth))
      Fail(mark, "lists or maps are nested more than " + std::to_string(kMostYamlDepth) +
                     " deep: this is not a camera or settings file");
    open_.push_back({is_map});
  }

  std::string name_;
  std::vector<Level> open_;
  int most_nodes_, nodes_ = 0;
};

}  // namespace

void CheckYaml(const std::string& text, const std::string& name, int most_nodes) {
  std::istringstream stream(text);
  Checker checker(name, most_nodes);
  try {
    YAML::Parser parser(stream);
    if (parser.HandleNextDocument(checker) && parser.HandleNextDocument(checker))
      ThrowInput(name +
                 ": contains a second document (after a line `---`), which would be ignored");
  } catch (const YAML::Exception& error) {
    checker.Fail(error.mark, error.msg);
  }
}

}  // namespace alidade
