#include "alidade/semidense/semidense_mapper.h"

namespace alidade {

SemiDenseMapper::SemiDenseMapper(MapStore& map, const Camera& camera,
                                 const SemiDenseSettings& settings)
    : map_(map), camera_(camera), settings_(settings) {
  settings_.Check();
}

SemiDenseMapper::~SemiDenseMapper() = default;

void SemiDenseMapper::Keep(KeyFrameId id, std::shared_ptr<const Picture> picture) {
  std::lock_guard<std::mutex> lock(inbox_mutex_);
  inbox_.push_back({id, std::move(picture)});
}

void SemiDenseMapper::Process(KeyFrameId, const std::atomic<bool>*) { (void)map_; }

void SemiDenseMapper::Finish() {}

}  // namespace alidade
