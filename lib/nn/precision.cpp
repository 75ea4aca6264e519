#include "nn/precision.h"

#include <dnnl.h>

#include "base/error.h"

namespace dexremoe {

bool HasNativeBfloat16() {
  const int isa = dnnl_get_effective_cpu_isa();
  return (isa & dnnl_cpu_isa_avx512_core_bf16) == dnnl_cpu_isa_avx512_core_bf16;
}

std::vector<std::string> NativePrecisions() {
  return HasNativeBfloat16() ? std::vector<std::string>{"f32", "bf16"}
                             : std::vector<std::string>{"f32"};
}

std::string ResolvePrecision(const std::string& choice) {
  const bool native = HasNativeBfloat16();
  if (choice == "auto") return native ? "bf16" : "f32";
  if (choice != "f32" && choice != "bf16")
    Fail("precision: expected auto, f32 or bf16, found '{}'", choice);
  if (choice == "bf16" && !native)
    Fail("precision: expected f32, as this processor has neither avx512_bf16 nor AMX; found bf16");
  return choice;
}

}  // namespace dexremoe
