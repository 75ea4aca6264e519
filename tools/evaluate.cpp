// Runs a trained policy on a set of objects and says how often it reaches its goals.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/log.h"
#include "eval/eval_file.h"
#include "eval/evaluation.h"
#include "eval/report.h"
#include "eval/trace.h"
#include "rl/policy_file.h"
#include "rl/policy_runner.h"

namespace {

using namespace dexremoe;

constexpr char kHold[] = "hold";  // for --policy

struct EvaluateOptions {
  std::string policy, objects, split = "train", out;
  std::string trace, trace_choice = "best";
  std::vector<std::string> earlier;
  int trace_episodes = 4;
  std::uint64_t seed = 1;
  int workers = 0;
  EvalOptions eval;
  TaskOptions task;
  SimOptions sim;
  HandOptions hand;

  void Register(Options& options) {
    options.Add("policy", &policy, "checkpoint or weights of any stage or method; hold: no actions")
        .Required();
    options.Add("earlier", &earlier,
                "checkpoints of the stages before, whose samples count with the policy's");
    options.Add("objects", &objects, "objects.csv").Required();
    options.Add("split", &split, "which objects").Choices({"train", "ood", "all"});
    options.Add("out", &out, "evaluation to write (dexremoe.eval)").Required().NotStored();
    options.Add("trace", &trace, "also record episodes at the first tolerance into this file")
        .NotStored();
    options.Add("trace_episodes", &trace_episodes, "how many to record").Range(1, 1000);
    options
        .Add("trace_choice", &trace_choice,
             "which to record; each object once, then again (typical: once)")
        .Choices({"best", "worst", "first", "typical"});
    options.Add("seed", &seed, "seed of starts, goals, pushes and intervals");
    options.Add("workers", &workers, "threads; 0 = all processors").NotStored();
    eval.Register(options);
    task.Register(options);
    sim.Register(options);
    hand.Register(options);
  }
};

std::vector<ObjectEntry> SelectEntries(const EvaluateOptions& o) {
  std::vector<ObjectEntry> entries = ReadObjectList(o.objects);
  if (o.split != "all")
    std::erase_if(entries, [&](const ObjectEntry& entry) { return entry.split != o.split; });
  if (entries.empty()) Fail("{}: expected objects of split {}, found none", o.objects, o.split);
  return entries;
}

// The files whose content decides the result, for the provenance.
std::vector<std::string> Inputs(const EvaluateOptions& o, const std::vector<ObjectEntry>& entries) {
  std::vector<std::string> inputs = {o.objects};
  if (o.policy != kHold) inputs.push_back(o.policy);
  for (const ObjectEntry& entry : entries) inputs.push_back(entry.grasps);
  if (o.eval.category != "label")
    for (const ObjectEntry& entry : entries) inputs.push_back(entry.folder + "/shape.h5");
  return inputs;
}

EvalFile DescribeEval(const EvaluateOptions& o, const EvalSetup& setup) {
  EvalFile file;
  file.policy = std::filesystem::path(o.policy).filename().string();
  file.engine = setup.sim.engine;
  file.substeps = setup.sim.substeps;
  file.seed = setup.seed;
  file.push = o.eval.push;
  file.category_input = o.eval.category;
  for (const TaskObject& object : setup.objects)
    file.objects.push_back({object.name, kCategories[object.category], object.split});
  return file;
}

void RecordTrace(const EvaluateOptions& o, const EvalSetup& setup, const EvalRun& run,
                 const PolicyRunner* runner, const ActFunction& act, ThreadPool& pool,
                 const Provenance& provenance) {
  const auto jobs = ChooseEpisodes(run, o.trace_episodes, o.trace_choice);
  TraceFile trace;
  trace.policy = std::filesystem::path(o.policy).filename().string();
  trace.control_rate = setup.sim.control_rate / setup.task.action_repeat;
  trace.tolerance = run.tolerance;
  for (const Joint& joint : setup.hand.joints) trace.joint_names.push_back(joint.name);
  std::vector<float> gates;
  if (runner != nullptr) gates = runner->GateWeights();
  for (int e = 0; runner != nullptr && e < runner->gates(); ++e)
    trace.expert_names.push_back(fmt::format("expert {}", e + 1));
  trace.episodes = RecordEpisodes(setup, o.eval, run, jobs, act, gates, pool);
  WriteTrace(o.trace, trace, provenance);
  LogInfo("{}: {} episodes", o.trace, trace.episodes.size());
}

void Run(const EvaluateOptions& o, const Options& options) {
  const auto entries = SelectEntries(o);
  const Provenance provenance = MakeProvenance(options, o.seed, Inputs(o, entries));
  ObjectSetNeeds needs;
  if (o.policy != kHold) needs.cloud_points = ReadPolicyStructure(o.policy).cloud_points;
  EvalSetup setup{o.task, o.sim, LoadHand(o.hand), LoadObjects(entries, needs), o.seed};
  SetCategoryInput(o.eval.category, entries, setup.objects);
  ThreadPool pool(o.workers);
  std::unique_ptr<PolicyRunner> runner;
  if (o.policy != kHold) runner = std::make_unique<PolicyRunner>(o.policy, setup.objects, pool);
  const ActFunction act = runner ? PolicyActions(*runner) : HoldActions();
  if (o.task.goal_angle < 3.14159 || o.task.velocity_tolerance > 1 || o.task.gravity_factor < 1)
    LogWarning(
        "task.goal_angle {}, task.velocity_tolerance {} and task.gravity_factor {} make the task "
        "easier than the paper's",
        o.task.goal_angle, o.task.velocity_tolerance, o.task.gravity_factor);
  EvalFile file = DescribeEval(o, setup);
  if (runner) file.samples = runner->samples();
  for (const std::string& stage : o.earlier) file.samples += ReadPolicy(stage).samples;
  file.runs = Evaluate(setup, o.eval, act, pool);
  WriteEval(o.out, file, provenance);
  std::fputs(ReportOf(file).c_str(), stdout);
  if (!o.trace.empty())
    RecordTrace(o, setup, file.runs.front(), runner.get(), act, pool, provenance);
}

}  // namespace

int main(int argc, char** argv) {
  EvaluateOptions evaluate;
  dexremoe::Options options(
      "evaluate",
      "Evaluates a policy: successes per episode and object at each tolerance, the paper's five "
      "metrics with 95 % intervals, and how episodes end. An untrained policy is the checkpoint "
      "that train_base --samples=0 writes.",
      "evaluate --policy=base.h5 --objects=objects.csv --split=train --out=eval/base.h5 "
      "--trace=trace/base.h5");
  evaluate.Register(options);
  return dexremoe::RunTool(options, argc, argv, [&] { Run(evaluate, options); });
}
