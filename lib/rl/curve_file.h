// The learning curve as CSV: kCurveColumns, then wall-clock columns that only this file has.
#pragma once

#include <string>
#include <vector>

#include "rl/trainer.h"

namespace dexremoe {

class CurveFile {
 public:
  // `rows` are those of a resumed run; their times come from an older file at `path`, else nan. An
  // empty path writes nothing.
  CurveFile(std::string path, const std::vector<CurveRow>& rows);

  void Add(const CurveRow& row, const IterationTime& time, double samples);
  // Writes the file whole.
  void Write() const;

 private:
  struct Times {
    double seconds, rollout_rate, update_rate;  // s since the start; samples/s of either part
  };
  void ReadTimes();

  std::string path_;
  std::vector<CurveRow> rows_;
  std::vector<Times> times_;
};

}  // namespace dexremoe
