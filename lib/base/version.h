#pragma once

namespace dexremoe {

inline constexpr char kVersion[] = "0.1.0";

}  // namespace dexremoe
