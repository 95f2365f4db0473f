#include "detector.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/detect/class_names.h"
#include "arrays.h"

namespace alidade::python {
namespace {

// The functions that run in this thread, the innermost first: one may drive the Slam of another.
struct RunningDetector {
  explicit RunningDetector(const Detector* of) : detector(of), outer(innermost) {
    innermost = this;
  }
  ~RunningDetector() { innermost = outer; }
  RunningDetector(const RunningDetector&) = delete;
  RunningDetector& operator=(const RunningDetector&) = delete;

  const Detector* const detector;
  RunningDetector* const outer;
  static thread_local RunningDetector* innermost;
};
thread_local RunningDetector* RunningDetector::innermost = nullptr;

class CallableDetector : public Detector {
 public:
  explicit CallableDetector(py::object callable) : callable_(std::move(callable)) {
    names_ = CocoNames();
    if (py::hasattr(callable_, "class_names"))
      names_ = callable_.attr("class_names").cast<std::vector<std::string>>();
  }
  ~CallableDetector() override {
    const py::gil_scoped_acquire acquire;
    callable_ = py::object();
  }
  CallableDetector(const CallableDetector&) = delete;
  CallableDetector& operator=(const CallableDetector&) = delete;

  std::vector<Detection> Detect(const cv::Mat& image) override {
    const py::gil_scoped_acquire acquire;
    const RunningDetector running(this);
    try {
      std::vector<Detection> found;
      for (const py::handle& thing : callable_(ArrayOf(image)))
        found.push_back(DetectionFrom(thing, image.size()));
      std::stable_sort(found.begin(), found.end(),
                       [](const Detection& a, const Detection& b) { return a.score > b.score; });
      return found;
    } catch (const py::error_already_set& error) {  // its destructor requires the GIL
      // Not an error of the detector: raise it again later.
      if (error.matches(PyExc_KeyboardInterrupt)) {
        PyErr_SetInterrupt();
        return {};
      }
      ThrowInput(error.what());
    } catch (const py::cast_error& error) {
      ThrowInput(error.what());
    }
  }
  const std::vector<std::string>& ClassNames() const override { return names_; }

 private:
  Detection DetectionFrom(const py::handle& thing, cv::Size image) const {
    const auto values = py::reinterpret_borrow<py::object>(thing).cast<py::sequence>();
    if (values.size() != 6)
      ThrowInput("a detection is (class, score, x, y, width, height), not " +
                 py::repr(thing).cast<std::string>());
    const auto number = [&](size_t i) { return py::float_(values[i]).cast<float>(); };
    Detection detection;
    detection.class_id = ClassOf(values[0]);
    detection.score = number(1);
    detection.box =
        cv::Rect2f(number(2), number(3), number(4), number(5)) &
        cv::Rect2f(0, 0, static_cast<float>(image.width), static_cast<float>(image.height));
    return detection;
  }

  // -1 for an unknown name: objects of unknown classes are not excluded.
  int ClassOf(const py::object& value) const {
    if (!py::isinstance<py::str>(value)) return py::int_(value).cast<int>();
    const auto at = std::find(names_.begin(), names_.end(), value.cast<std::string>());
    return at == names_.end() ? -1 : static_cast<int>(at - names_.begin());
  }

  py::object callable_;
  std::vector<std::string> names_;
};

}  // namespace

bool IsCalledBy(const Detector* detector) {
  for (const auto* one = RunningDetector::innermost; one != nullptr; one = one->outer) {
    if (one->detector == detector) return true;
  }
  return false;
}

std::shared_ptr<Detector> DetectorOf(py::object callable) {
  return std::make_shared<CallableDetector>(std::move(callable));
}

}  // namespace alidade::python
