#include "sim/contact/constrained_motion.h"

#include <algorithm>

#include "engine/core/parallel.h"

namespace condyle {

std::vector<std::size_t> obstructing_pairs(const ContactModel::State& state, const BodyMove& move) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < state.count(); ++i)
    if (move.obstructed_by(state.pair_or_complement(i))) list.push_back(i);
  return list;
}

SweptPair swept_pair(const ContactModel::State& state, const BodyMove& move,
                     const ColliderPair& pair, const Pose& to) {
  SweptPair swept;
  swept.pair = &pair;
  swept.a_moves = move.moves[index_of(pair.a->body)];
  const BodyId moving = (swept.a_moves ? pair.a : pair.b)->body;
  const BodyId still = (swept.a_moves ? pair.b : pair.a)->body;
  swept.X_CS = move.at[still];
  swept.X_DM = move.X_DM[index_of(moving)];
  swept.from = move.from();
  swept.to = to;
  swept.pivot_D = state.pivot[index_of(move.body)];
  swept.max_depth_mm = pair.apart_at_rest ? -1.0 : pair.rest_depth_mm + state.settings.slack_mm;
  swept.min_distance_mm = pair.min_distance_mm;
  swept.measure();
  return swept;
}

BodyPoses BodyMove::poses_at(const Pose& X_CD) const {
  BodyPoses poses = at;
  for (std::size_t b = 0; b < poses.X_CB.size(); ++b)
    if (moves[b]) poses.X_CB[b] = X_DM[b] ? X_CD * *X_DM[b] : X_CD;
  return poses;
}

BodyMove make_move(const ContactModel::State& state, BodyPoses at, BodyId body,
                   const Pose& target) {
  BodyMove move;
  move.body = body;
  move.moves.assign(at.X_CB.size(), false);
  move.X_DM.resize(at.X_CB.size());
  move.target = target;
  for (const BodyId b : state.bodies.subtree(body)) {
    move.moves[index_of(b)] = true;
    if (!bit_identical(at[b], at[body])) move.X_DM[index_of(b)] = at[body].inverse() * at[b];
  }
  move.at = std::move(at);
  return move;
}

MoveResult stop(const ContactModel::State& state, const BodyMove& move, ContactSet& set, bool exact,
                int threads) {
  const auto pairs = obstructing_pairs(state, move);
  const auto query_pairs = [&](const Pose& X_CD, const ContactSet& warm) {
    std::vector<PairContact> found(pairs.size());
    parallel_for(pairs.size(), threads, [&](std::size_t k) {
      const SweptPair swept = swept_pair(state, move, state.pair_or_complement(pairs[k]), X_CD);
      found[k] = swept.query(X_CD, state.start(&warm, pairs[k]), state.full_query(pairs[k]));
    });
    return found;
  };
  const auto store = [&](std::vector<PairContact>&& found) {
    for (std::size_t k = 0; k < pairs.size(); ++k) state.slot(set, pairs[k]) = std::move(found[k]);
  };
  std::vector<PairContact> at_target = query_pairs(move.target, set);
  if (bit_identical(move.from(), move.target)) {
    store(std::move(at_target));
    return {move.target, false};
  }
  std::vector<double> reached(pairs.size(), 1.0);
  parallel_for(reached.size(), threads, [&](std::size_t k) {
    SweptPair swept = swept_pair(state, move, state.pair_or_complement(pairs[k]), move.target);
    const PairContact& end = at_target[k];
    if (swept.clear(end)) return;
    if (swept.length_mm < 1e-12) {
      reached[k] = 0;
      return;
    }
    const PairContact start = exact
                                  ? state.slot(set, pairs[k])
                                  : swept.query(move.from(), {end.triangle_a, end.triangle_b}, {});
    swept.start_at(start);
    reached[k] = free_fraction(swept, start, end, 0.5 * state.settings.stop_gap_mm);
  });
  const double s = reached.empty() ? 1.0 : *std::min_element(reached.begin(), reached.end());
  if (s >= 1) {
    store(std::move(at_target));
    return {move.target, false};
  }
  const Pose X_CD = interpolate(move.from(), move.target, s, state.pivot[index_of(move.body)]);
  store(std::move(at_target));
  store(query_pairs(X_CD, set));
  return {X_CD, true};
}

}  // namespace condyle
