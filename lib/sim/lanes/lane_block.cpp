#include "sim/lanes/lane_block.h"

namespace dexremoe {

BlockLayout::BlockLayout(int joints_, int chains_, int cores) : joints(joints_), chains(chains_) {
  const auto take = [this](int count) {
    const int first = rows;
    rows += count;
    return first;
  };
  q = take(joints);
  qd = take(joints);
  target = take(joints);
  x = take(3);
  quat = take(4);
  v = take(3);
  w = take(3);
  push = take(3);
  free = take(1);
  contacts = take((chains + 1) * kSlots * kContactRows);
  inset = take(2 * cores);
  touch = take(chains);
  points = take(1);
  depth = take(1);
  root_mass = take(1);
  root_inertia = take(3);
  friction = take(1);
  torsion = take(1);
  gravity = take(3);
  kp = take(1);
  kd = take(1);
  com = take(3);
  reach = take(1);
  box = take(6);
  field = take(1);
  field_scale = take(3);
  field_shift = take(3);
  field_unit = take(1);
}

}  // namespace dexremoe
