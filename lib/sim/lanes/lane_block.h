// The state of the lanes engine: blocks of kBlockLanes environments, one environment per lane.
//
// A block is a table of rows, a row one number of every environment in it, so a kernel loads a row
// as one vector. All blocks share one layout, which follows from the hand. Integers (object, keys)
// are stored as the bits of int32.
#pragma once

#include <cstdint>
#include <vector>

namespace dexremoe {

inline constexpr int kBlockLanes = 16;  // of every instruction set; narrow ones pass several times
inline constexpr int kMaxJoints = 24;
inline constexpr int kMaxChains = 5;
inline constexpr int kMaxChainJoints = 6;
// Contact points kept between the object and one finger, or the palm: the deepest. Their memory is
// what warm starts the solver. A fourth point on a finger changes neither grasps nor survival but
// costs 7 % of the speed; on the palm an object may lie on its four corners.
inline constexpr int kFingerSlots = 3;
inline constexpr int kSlots = 4;
inline constexpr int kContactRows =
    6;  // key, normal impulse, friction impulse (3, W), spin impulse

// First row of each quantity. J joints, C chains (fingers).
// | quantity     | rows          | unit            | written by        |
// | q, qd        | J each        | rad, rad/s      | SetState, kernel  |
// | target       | J             | rad             | Step              |
// | x            | 3             | m, W; of the centre of mass | SetState, kernel |
// | quat         | 4             | w x y z, R_WB   | SetState, kernel  |
// | v, w         | 3 each        | m/s, rad/s; W   | SetState, kernel  |
// | push         | 3             | N, W            | PushObject; cleared by the kernel |
// | free         | 1             | 0 while held, else 1 | SetHeld      |
// | contacts     | (C+1)*kSlots*kContactRows | N s, N m s | kernel: last substep |
// | inset        | 2 * cores     | m: how far inside its end a core's contact was | kernel |
// | touch        | C             | 1: a tip carries force | kernel     |
// | points       | 1             | contact points that carry force | kernel |
// | depth        | 1             | m, deepest contact, >= 0 | kernel   |
// Physical parameters, written by SetObject:
// | root_mass    | 1             | sqrt(kg)        |
// | root_inertia | 3             | m sqrt(kg): roots of the principal moments |
// | friction     | 1             | 1               |
// | torsion      | 1             | m: torsional friction |
// | gravity      | 3             | m/s^2, W        |
// | kp, kd       | 1 each        | N m/rad, N m s/rad |
// | com          | 3             | m: the centre of mass in B |
// | reach        | 1             | m: bounding sphere about the origin of B |
// | box          | 6             | m: centre and half extents of the object's box in B |
// | field        | 1             | first node of the object's field (int32) |
// | field_scale  | 3             | nodes/m along the axes of B |
// | field_shift  | 3             | nodes: where the origin of B lies |
// | field_unit   | 1             | m per count     |
// B: the object's frame O turned so that its axes are the principal axes of inertia.
struct BlockLayout {
  BlockLayout() = default;
  BlockLayout(int joints, int chains, int cores);

  int joints = 0, chains = 0;
  int q, qd, target, x, quat, v, w, push, free, contacts, inset, touch, points, depth;
  int root_mass, root_inertia, friction, torsion, gravity, kp, kd, com, reach, box, field,
      field_scale, field_shift, field_unit;
  int rows = 0;

  int Contact(int group, int slot) const {
    return contacts + (group * kSlots + slot) * kContactRows;
  }
};

}  // namespace dexremoe
