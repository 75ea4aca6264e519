// The learning curve for TensorBoard, written as the training goes.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "io/event_file.h"
#include "rl/trainer.h"

namespace dexremoe {

class CurveEvents {
 public:
  // Continues the curve in `folder` after `samples` environment steps, which are TensorBoard's
  // steps; what a killed run wrote beyond them is cut off. An empty folder writes nothing.
  CurveEvents(const std::string& folder, std::int64_t samples);

  // `samples` of the iteration, for the rates (samples/s). `more`: further scalars by name.
  void Add(const CurveRow& row, const IterationTime& time, double samples,
           const std::vector<std::pair<std::string, double>>& more = {});

 private:
  std::unique_ptr<EventFile> file_;
};

}  // namespace dexremoe
