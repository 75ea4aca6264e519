// The best and worst objects as pictures, each above a moment of how its episodes end.
#pragma once

#include <string>
#include <vector>

#include "eval/ranking.h"
#include "eval/trace.h"
#include "render/canvas.h"
#include "render/renderer.h"
#include "task/object_set.h"

namespace dexremoe {

struct RankingSheetInputs {
  const Ranking& ranking;
  const std::vector<ObjectEntry>& entries;  // where the ranked objects' files stand
  const HandModel& hand;
  const TraceFile& trace;  // an episode of each ranked object; objects without one get no tile
  std::string trace_path;
};

// Two bands, worst and best. `width` in pixels; height follows. Throws Error naming an object that
// has no entry.
Image RankingSheet(Renderer& renderer, const Fonts& fonts, const RankingSheetInputs& inputs,
                   int width);

}  // namespace dexremoe
