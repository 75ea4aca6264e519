// The process-wide and per-thread parts of ODE.
#pragma once

#include <ode/ode.h>

#include <vector>

namespace dexremoe {

static_assert(sizeof(dReal) == sizeof(double), "the packaged ODE computes in double precision");

// Starts ODE once in the process. Its messages go to our log and its failed checks are thrown as
// Error: its own handlers print and exit. Safe from any thread.
void StartOde();

// Call on every thread before it steps a world.
void PrepareOdeThread();

// What worlds stepped one after the other share: the stepper's own (single) thread, its working
// memory, and the group of contact joints that live for one step. Belongs to one chunk of
// environments, so only one thread at a time uses it.
class OdeArena {
 public:
  OdeArena();
  ~OdeArena();
  OdeArena(const OdeArena&) = delete;
  OdeArena& operator=(const OdeArena&) = delete;

  dWorldID CreateWorld();
  dJointGroupID contact_joints() const { return contact_joints_; }
  // After an exception out of a step, before the next one. ODE's queue of jobs cannot be cleared or
  // freed then, so it is given up and replaced.
  void Recover();

 private:
  std::vector<dWorldID> worlds_;
  dThreadingImplementationID threading_;
  dJointGroupID contact_joints_;
  dWorldID memory_owner_;  // holds the working memory; never stepped
};

}  // namespace dexremoe
