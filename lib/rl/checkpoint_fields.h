// Groups of datasets of a checkpoint; used by checkpoint.cpp and policy_file.cpp alone.
#pragma once

#include <vector>

#include "io/h5.h"
#include "policy/policy.h"
#include "rl/train_state.h"

namespace dexremoe {

void WriteStructure(H5Writer& file, const PolicyStructure& structure);
PolicyStructure ReadStructure(const H5Reader& file);

// The policy and what it was trained on: all that acting takes. Reading throws Error as
// rl/policy_file.h says.
void WritePolicyPart(H5Writer& file, const TrainState& state);
void ReadPolicyPart(const H5Reader& file, TrainState& state);

void WriteCurriculum(H5Writer& file, const CurriculumState& state);
CurriculumState ReadCurriculum(const H5Reader& file);

// Nothing when there is none.
void WriteAdr(H5Writer& file, const AdrState& state);
AdrState ReadAdr(const H5Reader& file);

void WriteCard(H5Writer& file, const MethodCard& card);
MethodCard ReadCard(const H5Reader& file);

void WriteWindow(H5Writer& file, const std::vector<EpisodeRecord>& window);
std::vector<EpisodeRecord> ReadWindow(const H5Reader& file);

// The score of the best state so far, and what the next score rests on.
void WriteBest(H5Writer& file, const TrainState& state);
void ReadBest(const H5Reader& file, TrainState& state);

void WriteCurve(H5Writer& file, const std::vector<CurveRow>& curve);
std::vector<CurveRow> ReadCurve(const H5Reader& file);

void WriteEnvironment(H5Writer& file, const std::vector<std::vector<std::uint8_t>>& ranks);
std::vector<std::vector<std::uint8_t>> ReadEnvironment(const H5Reader& file);

// A few rows of normalised inputs and what the policy makes of them.
struct PolicyExample {
  std::vector<float> obs, phys;
  std::vector<int> object;
  std::vector<float> mean, value;
};
// The same rows always: drawn from a fixed stream.
PolicyExample MakeExample(const TrainState& state, const Policy<float>& policy);
void WriteExample(H5Writer& file, const PolicyExample& example);
// Throws Error when the stored outputs differ from `now` by more than rounding.
void CheckExample(const H5Reader& file, const PolicyExample& now);

}  // namespace dexremoe
