#pragma once

#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

#include "render/session/saved/saved_session.h"

// Each field of a view, listed once for reading and writing. `visit` has a function for each type
// of field; `view` and its parts are const when they are written. Only for this module and its
// test.
namespace condyle::session_fields {

inline constexpr std::array tools = {"look", "move", "measure", "landmarks", "cut"};
inline constexpr std::array left_tabs = {"parts", "look"};
inline constexpr std::array side_tabs = {"readings", "motion", "plan", "record", "face"};
inline constexpr std::array cut_places = {"left_joint", "right_joint", "mouth"};

/// Converts to a value of any type, to count the members of an aggregate.
struct Anything {
  template <class Type>
  operator Type() const;
};
/// Whether an aggregate can be initialised from `count` values.
template <class Aggregate, std::size_t count>
constexpr bool takes_values() {
  return []<std::size_t... i>(std::index_sequence<i...>) {
    return requires { Aggregate{(static_cast<void>(i), Anything{})...}; };
  }
  (std::make_index_sequence<count>());
}

// Two bases and ten members: a new one is listed in control_fields(), then counted here.
static_assert(takes_values<ViewState, 12>() && !takes_values<ViewState, 13>(),
              "list the new member of ViewState in control_fields()");

template <class Visit, class AnyLook>
void look_fields(Visit& visit, AnyLook& look) {
  // Complete: a new field does not compile until it is added here.
  auto& [clip, clip_skin, clip_from, clip_fraction, cut_away, cut_at, cut_radius_mm, ghost,
         wireframe, patches, paths, axes, springs, prisms, bone_springs, displacement,
         facial_muscles, muscle_labels, scale_bar, side_letters, folds, life, wipe, wipe_at,
         mirrored] = look;
  visit.flag("clip", clip);
  visit.flag("clip_skin", clip_skin);
  visit.letter("clip_from", clip_from, "LRAPSI");
  visit.number("clip_fraction", clip_fraction, 0, 1);
  visit.flag("cut_away", cut_away);
  visit.choice("cut_at", cut_at, cut_places);
  visit.number("cut_radius_mm", cut_radius_mm, 0, 1e4);
  visit.flag("ghost", ghost);
  visit.flag("wireframe", wireframe);
  visit.flag("patches", patches);
  visit.flag("paths", paths);
  visit.flag("axes", axes);
  visit.flag("springs", springs);
  visit.flag("prisms", prisms);
  visit.flag("bone_springs", bone_springs);
  visit.flag("displacement", displacement);
  visit.flag("facial_muscles", facial_muscles);
  visit.flag("muscle_labels", muscle_labels);
  visit.flag("scale_bar", scale_bar);
  visit.flag("letters", side_letters);
  visit.flag("folds", folds);
  visit.flag("life", life);
  visit.flag("wipe", wipe);
  visit.number("wipe_at", wipe_at, 0, 1);
  visit.text("mirrored", mirrored);
}

template <class Visit, class AnyEdits>
void edit_fields(Visit& visit, AnyEdits& edits) {
  // Complete: a new field does not compile until it is added here.
  auto& [obey_contact, mark_contacts, shadows, distances, measured_points, opening_mm, hands,
         landmarks, drawn_cut, motion, expression, look, skin_opacity, skin_to_return, parts,
         muscles, layers] = edits;
  visit.parts("parts", parts, &ViewNames::parts);  // first: points and landmarks name them
  visit.parts("muscles", muscles, &ViewNames::muscles);
  visit.parts("layers", layers, &ViewNames::layers);
  visit.flag("obey_contact", obey_contact);
  visit.flag("mark_contacts", mark_contacts);
  visit.flag("shadows", shadows);
  visit.flag("distances", distances);
  visit.points("measured", measured_points);
  visit.number("opening_mm", opening_mm, 0, 1000);
  visit.hands("hands", hands);
  visit.landmarks("landmarks", landmarks);
  visit.cut("drawn_cut", drawn_cut);
  visit.motion("motion", motion);
  visit.expression("expression", expression);
  visit.group("look", [&edits](auto& inside) { look_fields(inside, edits.look); });
  visit.number("skin_opacity", skin_opacity, 0, 1);
  visit.number("skin_to_return", skin_to_return, 0, 1);
}

template <class Visit, class AnyPanels>
void panel_fields(Visit& visit, AnyPanels& panels) {
  auto& [tab, left_tab, plots, plot_set] = panels;
  visit.choice("right_tab", tab, side_tabs);
  visit.choice("left_tab", left_tab, left_tabs);
  visit.flag("plots", plots);
  visit.index("plot_set", plot_set, 100);
}

/// The members of ViewState itself, without the clock, and without `chosen`, which names.chosen
/// stands for. Left out is what lasts for a moment: a released jaw
/// in motion (`falling`) and a handle that the mouse holds (`held_handle`).
template <class AnyView>
auto controls(AnyView& view) {
  return std::tie(view.playing, view.loop, view.speed, view.tool, view.landmark, view.selected);
}
inline bool same_controls(const ViewState& a, const ViewState& b) {
  return controls(a) == controls(b);
}

template <class Visit, class AnyView>
void control_fields(Visit& visit, AnyView& view) {
  visit.flag("playing", view.playing);
  visit.flag("loop", view.loop);
  visit.number("speed", view.speed, 0.1, 2);
  visit.number("time_s", view.time_s, 0, 1e6);
  visit.choice("tool", view.tool, tools);
  visit.name("chosen", &ViewNames::chosen);
  visit.index("landmark", view.landmark, 100000);
  visit.part("selected", view.selected);
}

}  // namespace condyle::session_fields
