#include "policy/category_rows.h"

#include <algorithm>

#include "nn/kernels.h"

namespace dexremoe {

template <typename W>
std::vector<int> CategoriesOf(const ShapeInputs<W>& shapes, int num_categories) {
  std::vector<int> categories;
  for (std::int64_t k = 0; k < shapes.objects; ++k) {
    const W* row = shapes.category + k * num_categories;
    categories.push_back(static_cast<int>(std::max_element(row, row + num_categories) - row));
  }
  return categories;
}

template <typename W>
CategoryRows SortByCategory(const PolicyRows<W>& rows, const std::vector<int>& category_of_object,
                            int num_categories) {
  CategoryRows sorted;
  sorted.begin.assign(num_categories + 1, 0);
  sorted.order.resize(rows.n);
  for (std::int64_t r = 0; r < rows.n; ++r) ++sorted.begin[category_of_object[rows.object[r]] + 1];
  for (int c = 0; c < num_categories; ++c) sorted.begin[c + 1] += sorted.begin[c];
  std::vector<int> next(sorted.begin.begin(), sorted.begin.end() - 1);
  for (std::int64_t r = 0; r < rows.n; ++r)
    sorted.order[next[category_of_object[rows.object[r]]]++] = static_cast<int>(r);
  return sorted;
}

template <typename T>
void GatherInput(const CategoryRows& sorted, const PolicyRows<Wide<T>>& rows, int obs_size,
                 int z_size, const T* z, T* input) {
  for (const int r : sorted.order) {
    Cast(obs_size, rows.obs + std::int64_t{r} * obs_size, input);
    input = std::copy_n(z + std::int64_t{r} * z_size, z_size, input + obs_size);
  }
}

#define DEX_INSTANTIATE(T)                                                                       \
  template void GatherInput(const CategoryRows&, const PolicyRows<Wide<T>>&, int, int, const T*, \
                            T*);
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE
template std::vector<int> CategoriesOf(const ShapeInputs<float>&, int);
template std::vector<int> CategoriesOf(const ShapeInputs<double>&, int);
template CategoryRows SortByCategory(const PolicyRows<float>&, const std::vector<int>&, int);
template CategoryRows SortByCategory(const PolicyRows<double>&, const std::vector<int>&, int);

}  // namespace dexremoe
