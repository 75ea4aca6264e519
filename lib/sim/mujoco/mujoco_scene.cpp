#if __has_include(<mujoco/mujoco.h>)
#include "sim/mujoco/mujoco_scene.h"

#include <mutex>
#include <string>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "base/log.h"
#include "sim/mujoco/mjcf.h"

namespace dexremoe {
namespace {

// The exception passes through MuJoCo's frames, which are compiled with unwinding tables; without
// a handler MuJoCo would write a log file and end the program.
[[noreturn]] void OnError(const char* message) { throw Error("MuJoCo: " + std::string(message)); }

// Warnings that matter are counted in mjData and looked at after a step.
void OnWarning(const char* message) { Log(LogLevel::kDebug, "MuJoCo: " + std::string(message)); }

void StartMujoco() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (mj_version() != mjVERSION_HEADER)
      Fail("MuJoCo: library: expected version {} as compiled with, found {}", mjVERSION_HEADER,
           mj_version());
    mju_user_error = OnError;
    mju_user_warning = OnWarning;
  });
}

// The virtual file system that MuJoCo reads the model's text from.
class ModelFile {
 public:
  explicit ModelFile(const std::string& text) : files_(std::make_unique<mjVFS>()) {
    mj_defaultVFS(files_.get());
    const int size = static_cast<int>(text.size());
    DEX_CHECK_EQ(mj_makeEmptyFileVFS(files_.get(), kName, size), 0);
    const int index = mj_findFileVFS(files_.get(), kName);
    std::copy(text.begin(), text.end(), static_cast<char*>(files_->filedata[index]));
  }
  ~ModelFile() { mj_deleteVFS(files_.get()); }
  ModelFile(const ModelFile&) = delete;
  ModelFile& operator=(const ModelFile&) = delete;

  mjModel* Load(char* error, int size) const {
    return mj_loadXML(kName, files_.get(), error, size);
  }

 private:
  static constexpr char kName[] = "model.xml";
  std::unique_ptr<mjVFS> files_;
};

int IdOf(const mjModel& model, mjtObj type, const std::string& name) {
  const int id = mj_name2id(&model, type, name.c_str());
  DEX_CHECK_GE(id, 0);
  return id;
}

void CheckPhysics(const EnvPhysics& physics, const std::string& what) {
  if (!(physics.mass > 0)) Fail("{}: mass: expected > 0 kg, found {}", what, physics.mass);
  if (!(physics.scale > 0)) Fail("{}: scale: expected > 0, found {}", what, physics.scale);
  if (!(physics.friction >= 0))
    Fail("{}: friction: expected >= 0, found {}", what, physics.friction);
  if (!(physics.torsional_friction >= 0))
    Fail("{}: torsional friction: expected >= 0 m, found {}", what, physics.torsional_friction);
}

// Scales a mesh geom of the object about O and moves it from O to the centre of mass.
void PlaceGeom(mjModel& model, int geom, double scale, const Eigen::Vector3d& com) {
  Eigen::Map<Eigen::Vector3d> p(model.geom_pos + 3 * geom), size(model.geom_size + 3 * geom);
  p = scale * p - com;
  size *= scale;
  model.geom_rbound[geom] *= scale;
  model.geom_sameframe[geom] = 0;
  const int mesh = model.geom_dataid[geom];
  float* vertex = model.mesh_vert + 3 * model.mesh_vertadr[mesh];
  for (int i = 0; i < 3 * model.mesh_vertnum[mesh]; ++i)
    vertex[i] = static_cast<float>(scale * vertex[i]);
}

}  // namespace

MujocoScene::MujocoScene(const SimOptions& options, const HandModel& hand,
                         std::vector<SimObject> objects)
    : options_(options), hand_(hand), objects_(std::move(objects)) {
  StartMujoco();
  for (const SimObject& object : objects_) prototypes_.push_back(Compile(object));
  const mjModel& model = *prototypes_.front();
  for (int j = 0; j < hand_.num_joints(); ++j) {
    const int id = IdOf(model, mjOBJ_JOINT, fmt::format("joint{}", j));
    joint_dof_.push_back(model.jnt_dofadr[id]);
    DEX_CHECK_EQ(model.jnt_qposadr[id], model.jnt_dofadr[id]);
  }
  collider_.resize(hand_.colliders.size());
  for (std::size_t i = 0; i < hand_.colliders.size(); ++i)
    collider_.at(IdOf(model, mjOBJ_GEOM, fmt::format("collider{}", i))) = static_cast<int>(i);
}

MujocoModel MujocoScene::Compile(const SimObject& object) const {
  char problem[1000] = "";
  const ModelFile file(MjcfOf(hand_, object, time_step()));
  MujocoModel model(file.Load(problem, sizeof problem));
  if (model == nullptr)
    Fail("MuJoCo: hand {} with object {}: {}", hand_.source, object.name, problem);
  DEX_CHECK_EQ(model->nv, num_dofs());
  DEX_CHECK_EQ(IdOf(*model, mjOBJ_BODY, "object"), object_body());
  return model;
}

std::shared_ptr<const mjModel> MujocoScene::ModelFor(int object, const EnvPhysics& physics) {
  const Key key = {static_cast<double>(object),
                   physics.mass,
                   physics.com.x(),
                   physics.com.y(),
                   physics.com.z(),
                   physics.scale,
                   physics.friction,
                   physics.torsional_friction};
  if (const auto found = variants_.find(key); found != variants_.end())
    if (auto model = found->second.lock()) return model;
  if (variants_.size() >= prune_at_) {
    std::erase_if(variants_, [](const auto& entry) { return entry.second.expired(); });
    prune_at_ = 2 * variants_.size() + 64;
  }
  std::shared_ptr<const mjModel> model = Variant(object, physics);
  variants_[key] = model;
  return model;
}

MujocoModel MujocoScene::Variant(int object, const EnvPhysics& physics) const {
  CheckPhysics(physics, "object " + objects_[object].name);
  MujocoModel model(mj_copyModel(nullptr, prototypes_[object].get()));
  const int body = object_body();
  const double inertia = physics.mass * physics.scale * physics.scale;
  model->body_mass[body] = physics.mass;
  for (int k = 0; k < 3; ++k) model->body_inertia[3 * body + k] *= inertia;
  for (int i = 0; i < model->body_geomnum[body]; ++i) {
    const int geom = model->body_geomadr[body] + i;
    // The larger coefficient of the two geoms counts; the hand's is zero.
    model->geom_friction[3 * geom] = physics.friction;
    model->geom_friction[3 * geom + 1] = physics.torsional_friction;
    // Of the number of rows too; MuJoCo would raise a coefficient of zero.
    if (physics.torsional_friction > 0) model->geom_condim[geom] = 4;
    PlaceGeom(*model, geom, physics.scale, physics.com);
  }
  const MujocoData data(mj_makeData(model.get()));
  mj_setConst(model.get(), data.get());
  return model;
}

}  // namespace dexremoe
#endif
