#include "alidade/run/any_source.h"

#include "alidade/run/synth_source.h"

namespace alidade {

std::unique_ptr<FrameSource> OpenAnySource(const std::string& source,
                                           const SourceOptions& options) {
  if (IsSynthSource(source)) return OpenSynthSource(source, options);
  return OpenSource(source, options);
}

}  // namespace alidade
