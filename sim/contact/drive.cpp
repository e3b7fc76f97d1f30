#include "sim/contact/drive.h"

#include <algorithm>

#include "engine/core/parallel.h"

namespace condyle {

std::vector<std::size_t> concerned_pairs(const ContactModel::State& state, const Drive& drive) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < state.count(); ++i)
    if (drive.concerns(state.judged(i))) list.push_back(i);
  return list;
}

Passage passage_of(const ContactModel::State& state, const Drive& drive, const ColliderPair& pair,
                   const Pose& to) {
  Passage passage;
  passage.pair = &pair;
  passage.a_moves = drive.moves[static_cast<std::size_t>(pair.a->body)];
  const auto moving = static_cast<std::size_t>((passage.a_moves ? pair.a : pair.b)->body);
  const auto still = static_cast<std::size_t>((passage.a_moves ? pair.b : pair.a)->body);
  passage.X_CS = drive.X_CB[still];
  passage.X_DM = drive.X_DM[moving];
  passage.from = drive.from();
  passage.to = to;
  passage.pivot_D = state.pivot[static_cast<std::size_t>(drive.body)];
  passage.limit_mm = pair.apart_at_rest ? -1.0 : pair.rest_depth_mm + state.settings.slack_mm;
  passage.kept_mm = pair.kept_mm;
  passage.measure();
  return passage;
}

std::vector<Pose> Drive::poses_at(const Pose& X_CD) const {
  std::vector<Pose> poses = X_CB;
  for (std::size_t b = 0; b < poses.size(); ++b)
    if (moves[b]) poses[b] = X_DM[b] ? X_CD * *X_DM[b] : X_CD;
  return poses;
}

Drive make_drive(const ContactModel::State& state, std::vector<Pose> X_CB, int body,
                 const Pose& wanted) {
  Drive drive;
  drive.body = body;
  drive.moves.assign(X_CB.size(), false);
  drive.X_DM.resize(X_CB.size());
  drive.wanted = wanted;
  drive.moves[static_cast<std::size_t>(body)] = true;
  if (body == mandible_body)
    for (std::size_t f = 0; f < state.carrier.size(); ++f) {
      const std::size_t b = first_free_body + f;
      if (state.carrier[f] != Body::mandible) continue;
      drive.moves[b] = true;
      if (!same_bits(X_CB[b], X_CB[mandible_body]))
        drive.X_DM[b] = X_CB[mandible_body].inverse() * X_CB[b];
    }
  drive.X_CB = std::move(X_CB);
  return drive;
}

Arrival stop(const ContactModel::State& state, const Drive& drive, ContactSet& set, bool exact,
             int threads) {
  const auto pairs = concerned_pairs(state, drive);
  const auto poses_look = [&](const Pose& X_CD, const ContactSet& warm) {
    std::vector<PairContact> found(pairs.size());
    parallel_for(pairs.size(), threads, [&](std::size_t k) {
      const Passage passage = passage_of(state, drive, state.judged(pairs[k]), X_CD);
      found[k] = passage.judged(X_CD, state.start(&warm, pairs[k]), state.full_look(pairs[k]));
    });
    return found;
  };
  const auto put = [&](std::vector<PairContact>&& found) {
    for (std::size_t k = 0; k < pairs.size(); ++k) state.slot(set, pairs[k]) = std::move(found[k]);
  };
  std::vector<PairContact> at_wanted = poses_look(drive.wanted, set);
  if (same_bits(drive.from(), drive.wanted)) {
    put(std::move(at_wanted));
    return {drive.wanted, false};
  }
  std::vector<double> reached(pairs.size(), 1.0);
  parallel_for(reached.size(), threads, [&](std::size_t k) {
    Passage passage = passage_of(state, drive, state.judged(pairs[k]), drive.wanted);
    const PairContact& end = at_wanted[k];
    if (passage.clear(end)) return;
    if (passage.length_mm < 1e-12) {
      reached[k] = 0;
      return;
    }
    const PairContact start =
        exact ? state.slot(set, pairs[k])
              : passage.judged(drive.from(), {end.triangle_a, end.triangle_b}, {});
    passage.start_at(start);
    reached[k] = free_share(passage, start, end, 0.5 * state.settings.stop_gap_mm);
  });
  const double s = reached.empty() ? 1.0 : *std::min_element(reached.begin(), reached.end());
  if (s >= 1) {
    put(std::move(at_wanted));
    return {drive.wanted, false};
  }
  const Pose X_CD =
      interpolate(drive.from(), drive.wanted, s, state.pivot[static_cast<std::size_t>(drive.body)]);
  put(std::move(at_wanted));
  put(poses_look(X_CD, set));
  return {X_CD, true};
}

}  // namespace condyle
