#include "sim/ode/ode_runtime.h"

#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <string>

#include "base/check.h"
#include "base/error.h"
#include "base/log.h"

namespace dexremoe {
namespace {

std::string Format(const char* format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  return text;
}

// ODE checks its numbers while it steps; a motion that is not finite ends here, in the middle of a
// step. The exception passes through ODE (C++, compiled with unwinding) to OdeSim, which names the
// environment.
[[noreturn]] void OnFailure(int, const char* message, va_list arguments) {
  throw Error("ODE: " + Format(message, arguments));
}

// The solver warns about near-singular pivots; the finite check after the step decides.
void OnMessage(int, const char* message, va_list arguments) {
  Log(LogLevel::kDebug, "ODE: " + Format(message, arguments));
}

}  // namespace

void StartOde() {
  static std::once_flag once;
  std::call_once(once, [] {
    dSetErrorHandler(OnFailure);
    dSetDebugHandler(OnFailure);
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
  worlds_.push_back(world);
  return world;
}

void OdeArena::Recover() {
  threading_ = dThreadingAllocateSelfThreadedImplementation();
  for (const dWorldID world : worlds_)
    dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(threading_),
                                         threading_);
  dWorldCleanupWorkingMemory(memory_owner_);
}

}  // namespace dexremoe
