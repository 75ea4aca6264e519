// Rows put in order of their object's category, for networks with a part per category: the rows of
// a category then lie side by side and go through its part in one product.
#pragma once

#include <vector>

#include "policy/policy.h"

namespace dexremoe {

struct CategoryRows {
  std::vector<int> order;  // [n]: place -> row; within a category in the order of the rows
  std::vector<int> begin;  // [categories + 1]: first place of each category, then n
};

// The category of each object [K] is that of its one-hot row.
template <typename W>
std::vector<int> CategoriesOf(const ShapeInputs<W>& shapes, int num_categories);

template <typename W>
CategoryRows SortByCategory(const PolicyRows<W>& rows, const std::vector<int>& category_of_object,
                            int num_categories);

// [o, z] of the rows in that order: input [n, obs_size + z_size]; z [n, z_size] in order of the
// rows.
template <typename T>
void GatherInput(const CategoryRows& sorted, const PolicyRows<Wide<T>>& rows, int obs_size,
                 int z_size, const T* z, T* input);

}  // namespace dexremoe
