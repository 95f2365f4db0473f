#include "alidade/detect/class_names.h"

#include <optional>

namespace alidade {
namespace {

constexpr size_t kMostClasses = 65536;

// Parser of Python literals.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}

  bool Take(char wanted) {
    SkipSpace();
    if (rest_.empty() || rest_.front() != wanted) return false;
    rest_.remove_prefix(1);
    return true;
  }

  std::optional<size_t> TakeNumber() {
    SkipSpace();
    size_t number = 0, digits = 0;
    while (digits < rest_.size() && rest_[digits] >= '0' && rest_[digits] <= '9' && digits < 6)
      number = 10 * number + static_cast<size_t>(rest_[digits++] - '0');
    if (digits == 0) return std::nullopt;
    rest_.remove_prefix(digits);
    return number;
  }

  std::optional<std::string> TakeString() {
    SkipSpace();
    if (rest_.empty() || (rest_.front() != '\'' && rest_.front() != '"')) return std::nullopt;
    const char quote = rest_.front();
    std::string text;
    for (size_t i = 1; i < rest_.size(); ++i) {
      if (rest_[i] == quote) {
        rest_.remove_prefix(i + 1);
        return text;
      }
      if (rest_[i] == '\\' && i + 1 < rest_.size()) ++i;
      text += rest_[i];
    }
    return std::nullopt;
  }

 private:
  void SkipSpace() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\n'))
      rest_.remove_prefix(1);
  }

  std::string_view rest_;
};

}  // namespace

const std::vector<std::string>& CocoNames() {
  static const std::vector<std::string> names = {"person",        "bicycle",      "car",
                                                 "motorcycle",    "airplane",     "bus",
                                                 "train",         "truck",        "boat",
                                                 "traffic light", "fire hydrant", "stop sign",
                                                 "parking meter", "bench",        "bird",
                                                 "cat",           "dog",          "horse",
                                                 "sheep",         "cow",          "elephant",
                                                 "bear",          "zebra",        "giraffe",
                                                 "backpack",      "umbrella",     "handbag",
                                                 "tie",           "suitcase",     "frisbee",
                                                 "skis",          "snowboard",    "sports ball",
                                                 "kite",          "baseball bat", "baseball glove",
                                                 "skateboard",    "surfboard",    "tennis racket",
                                                 "bottle",        "wine glass",   "cup",
                                                 "fork",          "knife",        "spoon",
                                                 "bowl",          "banana",       "apple",
                                                 "sandwich",      "orange",       "broccoli",
                                                 "carrot",        "hot dog",      "pizza",
                                                 "donut",         "cake",         "chair",
                                                 "couch",         "potted plant", "bed",
                                                 "dining table",  "toilet",       "tv",
                                                 "laptop",        "mouse",        "remote",
                                                 "keyboard",      "cell phone",   "microwave",
                                                 "oven",          "toaster",      "sink",
                                                 "refrigerator",  "book",         "clock",
                                                 "vase",          "scissors",     "teddy bear",
                                                 "hair drier",    "toothbrush"};
  return names;
}

std::vector<std::string> ParseClassNames(std::string_view text) {
  Reader reader(text);
  const bool table = reader.Take('{');
  if (!table && !reader.Take('[')) return {};
  const char end = table ? '}' : ']';
  std::vector<std::string> names;
  while (!reader.Take(end)) {
    const std::optional<size_t> number = table ? reader.TakeNumber() : names.size();
    if (!number || *number >= kMostClasses || (table && !reader.Take(':'))) return {};
    const std::optional<std::string> name = reader.TakeString();
    if (!name) return {};
    if (*number >= names.size()) names.resize(*number + 1);
    names[*number] = *name;
    if (!reader.Take(',')) {
      if (!reader.Take(end)) return {};
      break;
    }
  }
  return names;
}

std::vector<std::string> NamesFor(int classes, std::vector<std::string> from_file) {
  const auto& coco = CocoNames();
  const auto given = from_file.size();
  if (classes == 0) classes = static_cast<int>(given > 0 ? given : coco.size());
  std::vector<std::string> names = std::move(from_file);
  names.resize(static_cast<size_t>(classes));
  for (size_t i = 0; i < names.size(); ++i) {
    if (!names[i].empty()) continue;
    names[i] = given == 0 && names.size() == coco.size() ? coco[i] : "class " + std::to_string(i);
  }
  return names;
}

bool IsListed(const std::string& list, const std::string& name) {
  return ("," + list + ",").find("," + name + ",") != std::string::npos;
}

}  // namespace alidade
