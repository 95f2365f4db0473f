// An array with a copy in a vertex buffer. Changed pages are uploaded before drawing; after a
// context loss everything is.
#pragma once

#include <GLES3/gl3.h>

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

namespace alidade::gles {

// Pages of an array that changed since the last upload.
class ChangedPages {
 public:
  explicit ChangedPages(size_t page) : page_(page) {}  // values per page
  void Add(size_t value) {
    const size_t page = value / page_;
    if (page >= changed_.size()) changed_.resize(page + 1, false);
    changed_[page] = true;
  }
  // Calls upload(first, count) for each run of consecutive changed pages in an array of `size`
  // values, and marks all as unchanged.
  template <typename Upload>
  void Take(size_t size, Upload&& upload) {
    for (size_t page = 0; page < changed_.size(); ++page) {
      if (!changed_[page]) continue;
      const size_t first = page * page_;
      while (page < changed_.size() && changed_[page]) changed_[page++] = false;
      if (first < size) upload(first, std::min(page * page_, size) - first);
    }
  }
  void AddAll(size_t size) {
    if (size > 0) Add(size - 1);
    std::fill(changed_.begin(), changed_.end(), true);
  }

 private:
  size_t page_;
  std::vector<bool> changed_;
};

template <typename T>
class GpuArray {
  static_assert(std::is_trivially_copyable_v<T>, "compared and uploaded as bytes");

 public:
  size_t size() const { return values_.size(); }
  const T& operator[](size_t i) const { return values_[i]; }

  // `i` may equal size(): then the array grows by one.
  void Set(size_t i, const T& value) {
    if (i == values_.size()) {
      values_.push_back(value);
    } else if (std::memcmp(&values_[i], &value, sizeof value) == 0) {
      return;
    } else {
      values_[i] = value;
    }
    changed_.Add(i);
  }
  void Add(const T& value) { Set(size(), value); }
  void Shrink(size_t size) { values_.resize(std::min(size, values_.size())); }

  // Binds the buffer to GL_ARRAY_BUFFER and updates it. Returns the number of uploaded bytes.
  size_t Upload() {
    size_t bytes = 0;
    if (name_ == 0) {
      glGenBuffers(1, &name_);
      room_ = 0;
    }
    glBindBuffer(GL_ARRAY_BUFFER, name_);
    if (values_.size() > room_) {
      room_ = std::max<size_t>(kPage, values_.size() + values_.size() / 2);
      glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(room_ * sizeof(T)), nullptr,
                   GL_DYNAMIC_DRAW);
      changed_.AddAll(values_.size());
    }
    changed_.Take(values_.size(), [&](size_t first, size_t count) {
      glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(first * sizeof(T)),
                      static_cast<GLsizeiptr>(count * sizeof(T)), &values_[first]);
      bytes += count * sizeof(T);
    });
    return bytes;
  }

  void Forget() { name_ = 0, room_ = 0; }  // call when the context was lost
  void Release() {
    glDeleteBuffers(1, &name_);
    Forget();
  }

 private:
  static constexpr size_t kPage = 1024;
  std::vector<T> values_;
  ChangedPages changed_{kPage};
  GLuint name_ = 0;
  size_t room_ = 0;  // capacity of the buffer in values
};

}  // namespace alidade::gles
