#include "eval/sim_validation.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/log.h"

namespace dexremoe {
namespace {

constexpr double kDegree = M_PI / 180;

class Validation {
 public:
  Validation(const SimValidationOptions& options, const HandModel& hand, const TaskOptions& task,
             std::span<const SimObject> shapes, ThreadPool& pool)
      : options_(options), hand_(hand), task_(task), shapes_(shapes), pool_(pool) {
    engines_ = AvailableEngines(hand, &result_.notes);
    settings_ = ValidationSettings(engines_, options);
    if (Has("mujoco")) referee_ = settings_.back();
  }

  SimValidation Run() {
    for (const EngineSetting& setting : settings_) {
      LogInfo("{}: motion", setting.label);
      Motion(setting);
    }
    JointSteps();
    for (const std::string& engine : engines_) FindAll(engine);
    for (const EngineSetting& setting : settings_) {
      LogInfo("{}: grasps", setting.label);
      Hold(setting);
      Friction(setting);
      RandomTargets(setting);
    }
    Judge();
    return std::move(result_);
  }

 private:
  bool Has(const std::string& engine) const {
    return std::find(engines_.begin(), engines_.end(), engine) != engines_.end();
  }
  // The setting in which an engine finds grasps: its default, the referee's for MuJoCo.
  EngineSetting SourceOf(const std::string& engine) const {
    return engine == "mujoco" ? *referee_ : SettingOf(SimOptions(), engine, SimOptions().substeps);
  }

  void Record(const std::string& table, const std::string& row, const std::string& column,
              double value, int decimals, const std::string& spread = "") {
    result_.measurements.push_back({table, row, column, value, decimals, spread});
  }
  // The value at a place that was recorded; NaN elsewhere.
  double Recorded(const std::string& table, const std::string& row,
                  const std::string& column) const {
    for (const Measurement& m : result_.measurements)
      if (m.table == table && m.row == row && m.column == column) return m.value;
    return NAN;
  }

  void Motion(const EngineSetting& setting) {
    const FallError fall = FreeFallError(setting.sim, pool_);
    Record("motion", setting.label, "fall, mm", 1e3 * fall.position, 1);
    Record("motion", setting.label, "fall, mm/s", 1e3 * fall.velocity, 3);
    const TumbleError tumble = TumbleErrors(setting.sim, pool_);
    Record("motion", setting.label, "momentum, %", 100 * tumble.momentum, 2);
    Record("motion", setting.label, "energy, %", 100 * tumble.energy, 2);
    for (const double mu : {0.2, 0.5, 1.0}) {
      double worst = 0;
      for (const double direction : {0.0, 0.4, M_PI / 4}) {
        const double error = SlipAngle(setting.sim, mu, direction, pool_) - std::atan(mu);
        if (std::abs(error) >= std::abs(worst)) worst = error;
      }
      Record("slip", setting.label, fmt::format("friction {:.1f}", mu), worst / kDegree, 1);
    }
  }

  void JointSteps() {
    constexpr int kSteps = 30;
    for (const double amplitude : {0.1, 0.3, 0.8}) {
      std::vector<double> truth;
      if (referee_) truth = JointStepResponse(referee_->sim, hand_, amplitude, kSteps, pool_);
      for (const EngineSetting& setting : settings_) {
        const auto q = JointStepResponse(setting.sim, hand_, amplitude, kSteps, pool_);
        double worst = referee_ ? 0 : NAN;
        for (std::size_t i = 0; i < truth.size(); ++i)
          worst = std::max(worst, std::abs(q[i] - truth[i]));
        Record("joint", setting.label, fmt::format("{:.1f} rad", amplitude), worst, 4);
      }
    }
  }

  void FindAll(const std::string& engine) {
    const EngineSetting source = SourceOf(engine);
    GraspOptions grasp;
    grasp.count = options_.grasps;
    grasp.candidates = options_.candidates;
    std::vector<GraspedObject>& found = found_.emplace_back();
    for (const SimObject& shape : shapes_) {
      GraspCounts counts;
      const GraspSet set =
          TryFindGrasps(grasp, task_, source.sim, hand_, shape, options_.seed, pool_, &counts);
      LogInfo("{}: {}: {}", source.label, shape.name, counts.Text());
      Record("found", source.label, shape.name, static_cast<double>(set.grasps.size()), 0,
             fmt::format("({:.0f} %)", 100 * set.acceptance));
      found.push_back({shape, set.grasps});
    }
  }

  // Grasps of all engines in turn: starts that favour none.
  GraspedObject Pooled(std::size_t shape) const {
    GraspedObject pooled = {shapes_[shape], {}};
    for (std::size_t g = 0; g < static_cast<std::size_t>(options_.grasps); ++g)
      for (const auto& found : found_)
        if (g < found[shape].grasps.size()) pooled.grasps.push_back(found[shape].grasps[g]);
    return pooled;
  }

  void Hold(const EngineSetting& setting) {
    std::vector<HoldFigures> of_shape(shapes_.size());
    for (std::size_t e = 0; e < engines_.size(); ++e) {
      HoldFigures all;
      for (std::size_t s = 0; s < shapes_.size(); ++s) {
        const HoldFigures one = HoldGrasps(setting.sim, hand_, task_, found_[e][s], 1.0, pool_);
        Record("held " + engines_[e], setting.label, shapes_[s].name, 100 * one.HeldShare(), 1);
        all.Add(one);
        of_shape[s].Add(one);
      }
      Record("held " + engines_[e], setting.label, "all", 100 * all.HeldShare(), 1);
    }
    HoldFigures all;
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      Record("quiet", setting.label, shapes_[s].name, 100 * of_shape[s].QuietShare(), 1);
      all.Add(of_shape[s]);
    }
    Record("quiet", setting.label, "all", 100 * all.QuietShare(), 1);
  }

  void Friction(const EngineSetting& setting) {
    for (const double friction : {0.2, 0.4, 0.6})
      Record("friction", setting.label, fmt::format("friction {:.1f}", friction),
             100 * HoldGrasps(setting.sim, hand_, task_, Pooled(0), friction, pool_).HeldShare(),
             1);
  }

  void RandomTargets(const EngineSetting& setting) {
    double sum = 0, variance = 0;
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      const GraspedObject starts = Pooled(s);
      if (starts.grasps.empty()) continue;
      const SurvivalFigures one = Survive(setting.sim, hand_, task_, starts, options_, pool_);
      Record("survival", setting.label, shapes_[s].name, one.steps, 1,
             fmt::format("+- {:.1f}", one.error));
      Record("depth", setting.label, shapes_[s].name, 1e3 * one.depth_95, 2,
             fmt::format("/ {:.2f} / {:.2f}", 1e3 * one.depth_99, 1e3 * one.depth_max));
      sum += one.steps;
      variance += one.error * one.error;
    }
    Record("survival", setting.label, "sum", sum, 1, fmt::format("+- {:.1f}", std::sqrt(variance)));
  }

  // What the default setting of lanes (of ODE without lanes) has to reach.
  void Judge() {
    const std::string engine = Has("lanes") ? "lanes" : "ode";
    const std::string own = SourceOf(engine).label;
    const std::string truth = referee_ ? referee_->label : "";
    const auto judge = [&](const std::string& row, double value, int decimals, const char* wanted) {
      Record("goals", row, own, value, decimals, fmt::format("(wanted {})", wanted));
    };
    judge("ode's grasps that hold, %", Recorded("held ode", own, "all"), 1, ">= 97");
    judge("its grasps that hold in the referee, %", Recorded("held " + engine, truth, "all"), 1,
          ">= 95");
    double joint = NAN, slip = 0;
    for (const Measurement& m : result_.measurements) {
      if (m.row != own) continue;
      if (m.table == "joint") joint = std::fmax(joint, m.value);
      if (m.table == "slip") slip = std::max(slip, std::abs(m.value));
    }
    judge("joint step, rad", joint, 4, "<= 0.02");
    judge("slip angle, degrees", slip, 1, "<= 2");
    judge("quiet grasps, %", Recorded("quiet", own, "all"), 1, ">= 95");
    judge("survival over the referee's, %",
          100 * Recorded("survival", own, "sum") / Recorded("survival", truth, "sum"), 1,
          "90 to 110");
  }

  const SimValidationOptions& options_;
  const HandModel& hand_;
  const TaskOptions& task_;
  std::span<const SimObject> shapes_;
  ThreadPool& pool_;
  std::vector<std::string> engines_;
  std::vector<EngineSetting> settings_;
  std::optional<EngineSetting> referee_;
  std::vector<std::vector<GraspedObject>> found_;  // [engine][shape], as engines_
  SimValidation result_;
};

}  // namespace

void SimValidationOptions::Register(Options& options) {
  options.Add("grasps", &grasps, "wanted per engine and shape").Range(1, 1e6);
  options.Add("candidates", &candidates, "tried for them at most").Range(1, 1e9);
  options.Add("episodes", &episodes, "under random targets, per setting and shape").Range(1, 1e6);
  options.Add("referee_substeps", &referee_substeps, "MuJoCo's as referee").Range(1, 64);
  options.Add("noise", &noise, "spread of the random actions").Range(0, 100);
  options.Add("fall_distance", &fall_distance, "m from task.grasp_center; ends an episode")
      .Range(1e-3, 10);
  options.Add("seed", &seed, "of all random numbers");
}

void SimValidationOptions::MakeQuick() {
  grasps = 6;
  candidates = 128;
  episodes = 12;
  referee_substeps = 4;
}

std::vector<EngineSetting> ValidationSettings(const std::vector<std::string>& engines,
                                              const SimValidationOptions& options) {
  const SimOptions defaults;
  std::vector<EngineSetting> settings;
  const auto add = [&](const EngineSetting& setting) {
    for (const EngineSetting& other : settings)
      if (other.label == setting.label) return;
    settings.push_back(setting);
  };
  for (const std::string& engine : engines) {
    if (engine == "lanes") {
      add(SettingOf(defaults, engine, defaults.substeps));
      for (const int substeps : {1, 2, 4})
        for (const int iterations : {5, 10})
          add(SettingOf(defaults, engine, substeps, 1, iterations));
    } else if (engine == "ode") {
      for (const int substeps : {1, 2, 4}) add(SettingOf(defaults, engine, substeps));
    } else {
      add(SettingOf(defaults, engine, 2));
      add(SettingOf(defaults, engine, options.referee_substeps));
    }
  }
  return settings;
}

SimValidation ValidateSim(const SimValidationOptions& options, const HandModel& hand,
                          const TaskOptions& task, std::span<const SimObject> shapes,
                          ThreadPool& pool) {
  return Validation(options, hand, task, shapes, pool).Run();
}

}  // namespace dexremoe
