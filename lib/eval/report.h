// What `evaluate` prints: one table per tolerance and the metrics below it.
#pragma once

#include <string>

#include "eval/eval_file.h"

namespace dexremoe {

std::string ReportOf(const EvalFile& eval);

}  // namespace dexremoe
