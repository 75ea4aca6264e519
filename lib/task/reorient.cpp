#include "task/reorient.h"

#include <algorithm>

#include "base/bytes.h"
#include "base/check.h"
#include "base/error.h"
#include "task/reorient_impl.h"

namespace dexremoe {
namespace {

std::vector<SimObject> SimObjectsOf(const std::vector<TaskObject>& objects) {
  std::vector<SimObject> sim_objects;
  for (const TaskObject& object : objects) sim_objects.push_back(object.sim);
  return sim_objects;
}

}  // namespace

ReorientBatch::Impl::Impl(const TaskOptions& task_options, const SimOptions& sim_options,
                          const HandModel& hand_model, std::vector<TaskObject> task_objects,
                          std::unique_ptr<BatchSim> simulator, std::uint64_t run_seed,
                          ThreadPool& thread_pool)
    : options(task_options),
      control_rate(sim_options.control_rate),
      gravity(sim_options.gravity),
      hand(hand_model),
      objects(std::move(task_objects)),
      seed(run_seed),
      num_envs(simulator->num_envs()),
      joints(hand_model.num_joints()),
      phys_size(PhysSize(task_options, hand_model)),
      total_envs(num_envs),
      pool(thread_pool),
      sim(std::move(simulator)),
      running(num_envs, 1),
      motions(num_envs),
      physics(num_envs) {
  DEX_CHECK_EQ(sim->num_joints(), joints);
  options.Check();
  if (objects.empty()) Fail("objects: expected at least one, found none");
  for (const TaskObject& object : objects) {
    internal::CheckStarts(options, hand, object);
    object_keys.push_back(internal::ObjectKey(object.name));
  }
  state.Resize(num_envs, joints, phys_size);
  if (options.random.on) {
    state.ResizeRandom(num_envs, joints);
    randoms.resize(num_envs);
  }
  result.reward.assign(num_envs, 0);
  result.success.assign(num_envs, 0);
  result.end.assign(num_envs, EpisodeEnd::kNone);
}

ReorientBatch::ReorientBatch(const TaskOptions& task, const SimOptions& sim_options,
                             const HandModel& hand, std::vector<TaskObject> objects, int num_envs,
                             std::uint64_t seed, ThreadPool& pool) {
  auto sim = MakeBatchSim(sim_options, hand, SimObjectsOf(objects), num_envs, pool);
  impl_ = std::make_unique<Impl>(task, sim_options, hand, std::move(objects), std::move(sim), seed,
                                 pool);
  ResetAll();
}

ReorientBatch::ReorientBatch(const TaskOptions& task, const SimOptions& sim_options,
                             const HandModel& hand, std::vector<TaskObject> objects,
                             std::unique_ptr<BatchSim> sim, std::uint64_t seed, ThreadPool& pool)
    : impl_(std::make_unique<Impl>(task, sim_options, hand, std::move(objects), std::move(sim),
                                   seed, pool)) {
  ResetAll();
}

ReorientBatch::~ReorientBatch() = default;

int ReorientBatch::num_envs() const { return impl_->num_envs; }
int ReorientBatch::first_env() const { return impl_->first_env; }
int ReorientBatch::num_joints() const { return impl_->joints; }
int ReorientBatch::obs_size() const { return 6 * impl_->joints; }
int ReorientBatch::phys_size() const { return impl_->phys_size; }
int ReorientBatch::action_repeat() const { return impl_->options.action_repeat; }
const std::vector<TaskObject>& ReorientBatch::objects() const { return impl_->objects; }
const SimState& ReorientBatch::sim_state() const { return impl_->sim->state(); }
const std::vector<float>& ReorientBatch::obs() const { return impl_->state.obs; }
const std::vector<float>& ReorientBatch::phys() const { return impl_->state.phys; }
const std::vector<int>& ReorientBatch::object() const { return impl_->state.object; }
const std::vector<std::array<double, 4>>& ReorientBatch::goal() const { return impl_->state.goal; }
const std::vector<double>& ReorientBatch::angle() const { return impl_->state.angle; }
const std::vector<double>& ReorientBatch::distance() const { return impl_->state.distance; }
const EnvPhysics& ReorientBatch::physics(int env) const { return impl_->physics.at(env); }
const std::vector<double>& ReorientBatch::targets() const { return impl_->state.target; }
TaskOptions& ReorientBatch::mutable_options() { return impl_->options; }
void ReorientBatch::set_auto_reset(bool on) { impl_->auto_reset = on; }

void ReorientBatch::PlaceIn(int first, int total) {
  DEX_CHECK_GE(first, 0);
  DEX_CHECK_LE(first + num_envs(), total);
  impl_->first_env = first;
  impl_->total_envs = total;
}

void ReorientBatch::ResetAll() {
  for (int env = 0; env < num_envs(); ++env)
    impl_->Reset(env, impl_->ObjectInUse(env), first_env() + env);
}

void ReorientBatch::Reset(int env, int object, std::uint64_t episode) {
  impl_->Reset(env, object, episode);
}

const StepResult& ReorientBatch::Step(const std::vector<float>& actions) {
  Impl& m = *impl_;
  DEX_CHECK_EQ(actions.size(), static_cast<std::size_t>(m.num_envs) * m.joints);
  const auto row = [&](int env) { return &actions[static_cast<std::size_t>(env) * m.joints]; };
  m.ForEachEnv([&](int env) { m.Begin(env); });
  for (int repeat = 0; repeat < m.options.action_repeat; ++repeat) {
    m.ForEachEnv([&](int env) { m.Command(env, row(env)); });
    const std::vector<std::uint8_t>& running = m.running;
    const bool all = std::all_of(running.begin(), running.end(), [](auto on) { return on != 0; });
    m.sim->Step(m.state.target, all ? std::span<const std::uint8_t>() : running);
    m.ForEachEnv([&](int env) { m.Advance(env, row(env)); });
  }
  m.ForEachEnv([&](int env) { m.Observe(env); });
  m.EndEpisodes();
  return m.result;
}

std::vector<EpisodeRecord> ReorientBatch::TakeRecords() {
  return std::exchange(impl_->records, {});
}

void ReorientBatch::Push(int env, const Eigen::Vector3d& force) {
  impl_->sim->PushObject(env, force);
}

std::vector<std::uint8_t> ReorientBatch::Save() const {
  ByteWriter out;
  internal::SaveOptions(impl_->options, out);
  impl_->state.Save(out);
  internal::SaveRecords(impl_->records, out);
  for (int env = 0; env < num_envs(); ++env) {
    const EnvPhysics& p = impl_->physics[env];
    for (const double number :
         {p.mass, p.com.x(), p.com.y(), p.com.z(), p.friction, p.torsional_friction, p.scale})
      out.Put(number);
    out.PutVector(impl_->sim->Save(env));
  }
  return out.Take();
}

void ReorientBatch::Restore(const std::vector<std::uint8_t>& bytes) {
  ByteReader in(bytes);
  internal::RestoreOptions(in, impl_->options);
  impl_->state.Restore(in);
  for (const int object : impl_->state.object)
    if (object < 0 || object >= static_cast<int>(impl_->objects.size()))
      Fail("saved state: object: expected 0..{}, found {}", impl_->objects.size() - 1, object);
  impl_->records = internal::RestoreRecords(in);
  for (int env = 0; env < num_envs(); ++env) {
    EnvPhysics& p = impl_->physics[env];
    p = {};
    for (double* number :
         {&p.mass, &p.com[0], &p.com[1], &p.com[2], &p.friction, &p.torsional_friction, &p.scale})
      in.GetInto(*number);
    p.gravity = {0, 0, impl_->state.gravity[env]};
    if (impl_->options.random.on) impl_->RestoreRandom(env);
    impl_->sim->Restore(env, in.GetVector<std::uint8_t>());
  }
  in.Finish();
}

}  // namespace dexremoe
