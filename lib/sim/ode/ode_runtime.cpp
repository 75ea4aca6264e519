#include "sim/ode/ode_runtime.h"

#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <string>

#include "base/check.h"
#include "base/log.h"

namespace dexremoe {
namespace {

std::string Format(const char* format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  return text;
}

void OnBug(int, const char* message, va_list arguments) {
  internal::CheckFailed("ode", 0, "internal check of ODE", Format(message, arguments));
}

// The solver warns about near-singular pivots; the finite check after the step decides.
void OnMessage(int, const char* message, va_list arguments) {
  Log(LogLevel::kDebug, "ODE: " + Format(message, arguments));
}

}  // namespace

void StartOde() {
  static std::once_flag once;
  std::call_once(once, [] {
    dSetErrorHandler(OnBug);
    dSetDebugHandler(OnBug);
    dSetMessageHandler(OnMessage);
    DEX_CHECK_NE(dInitODE2(0), 0);
  });
}

void PrepareOdeThread() {
  thread_local const bool ready = dAllocateODEDataForThread(dAllocateMaskAll) != 0;
  DEX_CHECK(ready);
}

OdeArena::OdeArena() {
  StartOde();
  PrepareOdeThread();
  threading_ = dThreadingAllocateSelfThreadedImplementation();
  contact_joints_ = dJointGroupCreate(0);
  memory_owner_ = dWorldCreate();
}

OdeArena::~OdeArena() {
  dWorldDestroy(memory_owner_);
  dJointGroupDestroy(contact_joints_);
  dThreadingFreeImplementation(threading_);
}

dWorldID OdeArena::CreateWorld() {
  const dWorldID world = dWorldCreate();
  dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(threading_),
                                       threading_);
  DEX_CHECK_NE(dWorldUseSharedWorkingMemory(world, memory_owner_), 0);
  dWorldSetAutoDisableFlag(world, 0);
  return world;
}

}  // namespace dexremoe
