#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "engine/math/pchip.h"
#include "sim/case/muscle.h"

namespace condyle {

/// How much each muscle is excited over time.
struct Excitations {
  double duration_s = 0;
  std::vector<Pchip> of_muscle;  // one per muscle; a constant when the file has one row

  /// One value of 0 to 1 for each muscle; constant beyond the ends.
  std::vector<double> at(double time_s) const;
};

/// A CSV with the column time_s and one column per muscle, 0 to 1; smooth without overshoot between
/// its rows, time counted from the first. A column names a muscle ("lat"), a kind of both sides
/// ("at"), or a group: t temporalis, m masseter, my mylohyoid, lp lateral pterygoid, close, open,
/// hopen, pro, protracthyoid, retracthyoid, suprahyoid, infrahyoid, stiffenjaw, with l or r before
/// it for one side (bi_ before any name: both). What several columns say of a muscle adds up, to 1
/// at most. Lines that start with # are passed over. throws: InputError with file, line and value.
Excitations read_excitations(const std::filesystem::path& file, std::span<const Muscle> muscles);

}  // namespace condyle
