// A batch that is spread over processes.
#include "task_fixture.h"

namespace dexremoe {
namespace {

TEST(ReorientBatch, PartsOfABatchAreTheBatch) {
  TaskOptions options;
  options.episode_length = 5;  // several episodes one after another
  options.mass_range = {0.05, 0.15};
  FakeTask whole(options, 6);
  FakeTask parts[] = {FakeTask(options, 2), FakeTask(options, 4)};
  const int first[] = {0, 2};
  for (int p = 0; p < 2; ++p) {
    parts[p].batch->PlaceIn(first[p], 6);
    parts[p].batch->ResetAll();
  }
  for (int step = 0; step < 17; ++step) {
    whole.Step(0.5f, -0.2f);
    for (int p = 0; p < 2; ++p) {
      parts[p].Step(0.5f, -0.2f);
      for (int env = 0; env < parts[p].batch->num_envs(); ++env) {
        const int all = first[p] + env;
        EXPECT_EQ(parts[p].batch->object()[env], whole.batch->object()[all]);
        EXPECT_EQ(parts[p].batch->goal()[env], whole.batch->goal()[all]) << step;
        EXPECT_EQ(parts[p].batch->physics(env).mass, whole.batch->physics(all).mass) << step;
        EXPECT_EQ(parts[p].batch->angle()[env], whole.batch->angle()[all]) << step;
      }
    }
  }
  EXPECT_EQ(parts[1].batch->first_env(), 2);
}

}  // namespace
}  // namespace dexremoe
