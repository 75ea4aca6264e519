// Figures of the paper's studies: success per object for all methods (figure 5 there), and success
// against anything that evaluations were made at: pushes, sizes, samples.
//
// `missing` are labels of methods without an evaluation; the figures name them as missing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "eval/plots.h"

namespace dexremoe {

// S_mean with its 95 % interval against x, one number a method; those of one label make one line. A
// few lines share a panel; of more, each stands beside the last.
// Throws Error when a method lacks the tolerance.
Figure StudyFigure(const std::vector<EvaluatedMethod>& methods, const std::vector<double>& x,
                   const std::string& x_label, double tolerance,
                   const std::vector<std::string>& missing);

// The same against the samples that the evaluated policies have seen.
Figure GrowthFigure(const std::vector<EvaluatedMethod>& methods, double tolerance,
                    const std::vector<std::string>& missing);

// A panel for every method but the last: S_i with 95 % intervals beside those of the last, training
// objects in ascending order under the last. Throws Error as BarsFigure.
Figure SortedFigure(const std::vector<EvaluatedMethod>& methods, double tolerance,
                    const std::vector<std::string>& missing);

// A panel for every object: S_i of each method, one below the other, with 95 % intervals. `objects`
// index the evaluations' objects. Throws Error as BarsFigure.
Figure ObjectPanelsFigure(const std::vector<EvaluatedMethod>& methods, double tolerance,
                          const std::vector<int>& objects, const std::vector<std::string>& missing);

// The `count` training objects with the lowest S_i, averaged over all methods but the last (over
// that one where it is alone); ascending.
std::vector<int> HardestObjects(const std::vector<EvaluatedMethod>& methods, double tolerance,
                                int count);
// `count` objects out of distribution, drawn by seed; ascending in S_i under the last method. All
// of them where there are no more; none is an Error.
std::vector<int> RandomOtherObjects(const std::vector<EvaluatedMethod>& methods, double tolerance,
                                    int count, std::uint64_t seed);

// Throws Error naming the method whose objects are not those of the first.
void CheckSameObjects(const std::vector<EvaluatedMethod>& methods);

}  // namespace dexremoe
