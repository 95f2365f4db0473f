// Looks at some images of a recording before it is played: units, ranges and pairs that cannot be.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

struct SourceFindings {
  // What the images show and what was assumed to read them, for users: "depth from 0.6 to 4.1 m".
  // Empty: nothing to say.
  std::string told;
  // Why the right or depth images cannot be used; empty: they can. The run goes on with one camera,
  // or is refused if the user asked for the sensor.
  std::string unusable;
};

struct InspectedSource {
  std::unique_ptr<FrameSource> source;  // at its first frame
  std::string told;                     // SourceInfo::told, and what the images show
};

// Opens `source` (see OpenAnySource()) and inspects it. Where its right or depth images cannot be
// used, it is opened again as that of one camera, with a warning, and wanted.sensor says so; if
// wanted.sensor asked for them, throws Error (input).
InspectedSource OpenInspected(const std::string& source, SourceOptions& wanted);

// Reads some images of `source` and rewinds it. Warns of a calibration that is improbable. A source
// that cannot seek is judged by its calibration alone.
SourceFindings Inspect(FrameSource& source);

}  // namespace alidade
