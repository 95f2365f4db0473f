#include "alidade/io/files/calibrations/opencv_xml.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/yaml_check.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

class Converter {
 public:
  Converter(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::string Convert() {
    SkipToElement();
    const std::string root = Open();
    if (root != "opencv_storage") Fail("expected <opencv_storage>, not <" + root + ">");
    if (empty_) return "{}";
    Content(root, 0);
    return std::move(out_);
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    const auto line =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    ThrowInput(name_ + ":" + std::to_string(line + 1) + ": " + what);
  }
  bool Starts(std::string_view with) const { return text_.substr(at_, with.size()) == with; }
  void Move(size_t to) {
    if (to == std::string_view::npos) Fail("the XML ends too early: the file is damaged");
    out_.append(
        static_cast<size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                       text_.begin() + static_cast<std::ptrdiff_t>(to), '\n')),
        '\n');
    at_ = to;
  }
  // White space, comments and <?…?>.
  void SkipToElement() {
    while (true) {
      Move(std::min(text_.find_first_not_of(kBlank, at_), text_.size()));
      const char* end = Starts("<!--") ? "-->" : Starts("<?") ? "?>" : nullptr;
      if (!end) return;
      const size_t found = text_.find(end, at_);
      Move(found == std::string_view::npos ? found : found + std::string_view(end).size());
    }
  }
  // <name attribute="…">, or <name/>.
  std::string Open() {
    if (!Starts("<")) Fail("expected an element such as <camera_matrix>");
    const size_t end = text_.find('>', at_);
    if (end == std::string_view::npos) Move(end);
    std::string_view tag = text_.substr(at_ + 1, end - at_ - 1);
    empty_ = !tag.empty() && tag.back() == '/';
    if (empty_) tag.remove_suffix(1);
    const std::string_view name = tag.substr(0, tag.find_first_of(kBlank));
    if (name.empty() || name.size() > 100 ||
        name.find_first_of("\"\\<&/{}") != std::string_view::npos)
      Fail("an element without a name");
    Move(end + 1);
    return std::string(name);
  }
  void Close(const std::string& name) {
    if (!Starts("</" + name + ">")) Fail("expected </" + name + ">");
    Move(at_ + name.size() + 3);
  }
  void Content(const std::string& name, int depth) {
    if (depth >= kMostYamlDepth)
      Fail("elements are nested more than " + std::to_string(kMostYamlDepth) +
           " deep: this is not a camera file");
    SkipToElement();
    if (!Starts("<")) return Text(name);
    if (Starts("</")) {
      out_ += "\"\"";
      return Close(name);
    }
    const bool list = Starts("<_>") || Starts("<_ ");
    out_ += list ? '[' : '{';
    while (!Starts("</")) {
      const std::string child = Open();
      const bool empty = empty_;
      if (list != (child == "_")) Fail("list items (<_>) and named elements are mixed");
      if (!list) out_ += '"' + child + "\": ";
      if (empty) {
        out_ += "\"\"";
      } else {
        Content(child, depth + 1);
      }
      out_ += ',';
      SkipToElement();
    }
    out_ += list ? ']' : '}';
    Close(name);
  }
  void Text(const std::string& name) {
    const size_t end = text_.find('<', at_);
    if (end == std::string_view::npos) Move(end);
    const std::string_view all = text_.substr(at_, end - at_);
    const auto words = Words(all);
    if (words.size() > 1 && std::all_of(words.begin(), words.end(), [](std::string_view word) {
          return ParseNumber(word) || (word.size() < 6 && word.find('.') != std::string_view::npos);
        })) {
      out_ += '[';
      for (const std::string_view word : words) out_.append(word) += ", ";
      out_ += ']';
      Move(end);
    } else {
      out_ += '"';
      for (const char c : all) {
        if (c == '"') continue;  // OpenCV's quotes around text with blanks
        if (c == '\\') out_ += '\\';
        out_ += kBlank.find(c) == std::string_view::npos ? c : ' ';
      }
      while (out_.back() == ' ') out_.pop_back();
      out_ += '"';
      Move(end);
    }
    SkipToElement();  // a comment
    Close(name);
  }
  static std::vector<std::string_view> Words(std::string_view text) {
    std::vector<std::string_view> words;
    for (size_t begin = text.find_first_not_of(kBlank); begin != std::string_view::npos;) {
      const size_t end = text.find_first_of(kBlank, begin);
      words.push_back(text.substr(begin, end - begin));
      begin = text.find_first_not_of(kBlank, end);
    }
    return words;
  }

  std::string_view text_;
  const std::string& name_;
  std::string out_;
  size_t at_ = 0;
  bool empty_ = false;  // the last element was <name/>
};

}  // namespace

std::string YamlOfOpenCvXml(const std::string& text, const std::string& name) {
  return Converter(std::string_view(text), name).Convert();
}

}  // namespace alidade
