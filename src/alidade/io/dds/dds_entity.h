// Owners of Cyclone's handles.
#pragma once

#include <dds/dds.h>

#include <memory>
#include <stdexcept>
#include <string>

namespace alidade {

// Closes a DDS entity, and all that were created under it.
class DdsEntity {
 public:
  DdsEntity() = default;
  explicit DdsEntity(dds_entity_t handle) : handle_(handle) {}
  ~DdsEntity() { Close(); }
  DdsEntity(DdsEntity&& other) noexcept : handle_(other.handle_) { other.handle_ = 0; }
  DdsEntity& operator=(DdsEntity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  dds_entity_t get() const { return handle_; }
  bool valid() const { return handle_ > 0; }
  void Close() {
    if (handle_ > 0) dds_delete(handle_);
    handle_ = 0;
  }

 private:
  dds_entity_t handle_ = 0;
};

// Throws std::runtime_error if Cyclone returned an error instead of an entity.
inline DdsEntity Checked(dds_entity_t made, const char* what) {
  if (made < 0) throw std::runtime_error(std::string(what) + ": " + dds_strretcode(made));
  return DdsEntity(made);
}

struct DeleteQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, DeleteQos>;

}  // namespace alidade
