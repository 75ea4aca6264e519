// Fills the cache of stable grasps of one object.

#include <spdlog/fmt/fmt.h>

#include <chrono>

#include "base/log.h"
#include "base/options.h"
#include "task/grasp_search.h"

namespace dexremoe {
namespace {

struct FindGraspsOptions {
  std::string mesh, parts, out;
  int workers = 0;
  std::uint64_t seed = 1;
  GraspOptions grasp;
  TaskOptions task;
  SimOptions sim;
  HandOptions hand;

  void Register(Options& options) {
    options.Add("mesh", &mesh, "mesh.h5 of the object").Required();
    options.Add("parts", &parts, "parts.h5 of the object").Required();
    options.Add("out", &out, "grasps.h5 to write").Required().NotStored();
    options.Add("workers", &workers, "threads; 0: one per processor").Range(0, 1024).NotStored();
    options.Add("seed", &seed, "of all random numbers");
    grasp.Register(options);
    task.Register(options);
    sim.Register(options);
    hand.Register(options);
  }
};

void Run(const FindGraspsOptions& o, const Options& options) {
  const HandModel hand = LoadHand(o.hand);
  const TaskObject object = LoadSimObject(o.mesh, o.parts);
  ThreadPool pool(o.workers);
  GraspCounts counts;
  const auto start = std::chrono::steady_clock::now();
  const GraspSet set = FindGrasps(o.grasp, o.task, o.sim, hand, object.sim, o.seed, pool, &counts);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (static_cast<int>(set.grasps.size()) < o.grasp.count)
    LogWarning("{}: {} of {} grasps found: {}", object.name, set.grasps.size(), o.grasp.count,
               counts.Text());
  WriteGrasps(o.out, set, MakeProvenance(options, o.seed, {o.mesh, o.parts, o.hand.urdf}));
  fmt::print("object      {}\n", object.name);
  fmt::print("grasps      {} of {}\n", set.grasps.size(), counts.Text());
  fmt::print("acceptance  {:.1f} % on {}\n", 100.0 * counts.accepted / counts.tried, o.sim.engine);
  if (o.grasp.certify != "none")
    fmt::print("certified   {:.1f} % of them on {}\n", 100.0 * counts.certified / counts.accepted,
               o.grasp.certify);
  fmt::print("rate        {:.1f} accepted/s, {:.0f} candidates/s on {} threads ({:.1f} s)\n",
             counts.accepted / seconds, counts.tried / seconds, pool.workers(), seconds);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("find_grasps", "Finds stable grasps of an object: starts of episodes.",
                  "find_grasps --mesh=NAME/mesh.h5 --parts=NAME/parts.h5 --out=NAME/grasps.h5");
  FindGraspsOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] { Run(o, options); });
}
