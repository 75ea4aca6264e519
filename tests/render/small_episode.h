// A hand of one joint and an episode of it.
#pragma once

#include <cmath>

#include "eval/trace.h"
#include "hand/hand_model.h"
#include "test_meshes.h"

namespace dexremoe {

// A palm and one finger of one joint.
inline HandModel SmallHand() {
  HandModel hand;
  hand.source = "small.urdf";
  hand.links.resize(2);
  hand.links[0].visual = CubeOf(0.03);
  hand.links[1].visual = BallOf(0.015, 16);
  Joint joint;
  joint.name = "bend";
  joint.child = 1;
  joint.X_PJ.p = {0, 0.08, 0.03};
  hand.joints = {joint};
  hand.chains = {{0}};
  return hand;
}

// The object turns about z at 1 rad/s towards one goal; reaches it at step 30, then another.
inline TraceFile SmallTrace(int length) {
  TraceFile trace;
  trace.tolerance = 0.4;
  trace.joint_names = {"bend"};
  trace.expert_names = {"one", "two"};
  EpisodeTrace episode;
  episode.object = "ball";
  episode.category = "head";
  for (int t = 0; t < length; ++t) {
    episode.joint_position.push_back(0.01 * t);
    for (double v : {0.0, 0.06, 0.12}) episode.object_position.push_back(v);
    for (double v : {std::cos(t / 120.0), 0.0, 0.0, std::sin(t / 120.0)})
      episode.object_rotation.push_back(v);
    for (double v : {1.0, 0.0, 0.0, 0.0}) episode.goal_rotation.push_back(v);
    episode.angle.push_back(t / 60.0);
    episode.success.push_back(t == 30);
    for (float v : {0.25f, 0.75f}) episode.gate.push_back(v);
  }
  episode.successes = length > 30;
  trace.episodes = {episode};
  return trace;
}

}  // namespace dexremoe
