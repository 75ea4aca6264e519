// Fingerprints of bytes: of files in provenances, of parameters in files of weights.
#pragma once

#include <string>
#include <string_view>

namespace dexremoe {

// XXH3 with 128 bits, as 32 hexadecimal digits.
std::string HashOf(std::string_view bytes);

}  // namespace dexremoe
