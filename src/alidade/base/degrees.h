#pragma once

namespace alidade {

inline constexpr double kDegrees = 57.29577951308232;  // of a radian

}  // namespace alidade
