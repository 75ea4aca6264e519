// In which precision networks compute while they train.
#pragma once

#include <string>
#include <vector>

namespace dexremoe {

// True where the processor has products of bfloat16 (avx512_bf16 or AMX) that oneDNN uses.
bool HasNativeBfloat16();

// f32, and bf16 where it is native.
std::vector<std::string> NativePrecisions();

// "f32" or "bf16" for a choice of "auto", "f32" or "bf16"; auto takes bf16 where it is native.
// Throws Error for bf16 where it is not, and for other words.
std::string ResolvePrecision(const std::string& choice);

}  // namespace dexremoe
