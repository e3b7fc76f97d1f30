#pragma once

namespace condyle {

/// The patient of the demonstration bimaxillary-by-hand.
constexpr const char* by_hand_patient = "built-in:class-iii";

/// What its hand does, see render/window/input/input_steps.h; {out} is the folder of the results.
constexpr const char* by_hand_steps =
    R"(# A class III patient: an operation of both jaws, planned in the window from an empty plan.
say An empty plan for a patient with a protruding lower jaw
click tab:Plan
picture 1-before

say The upper jaw is cut and moved forward and up, more so behind
choose plan-osteotomy le_fort_1
wait plan-step:1
choose plan-move maxilla
wait plan-step:2
click plan-step:2
enter plan-number:forward_mm 4
enter plan-number:up_mm 3
picture 2-upper-jaw
click plan-step:2

say The lower jaw is split, and its front part is placed by the bite
choose plan-osteotomy sagittal_split
wait plan-step:3
choose plan-occlude distal
wait plan-step:4
picture 3-bite

say The plan is saved; from now on with every edit
enter plan-file {out}/plan.json
click plan-save

say The chin is cut, and dragged forward by its arrow
choose plan-osteotomy genioplasty
wait plan-step:5
key l
key m
choose body chin
drag handle:P -6 0
picture 4-chin
click plan-take
wait plan-step:6
key m

say Splints for the operation
wheel plan-osteotomy 20
choose plan-splint intermediate-upper
wait splint-findings
choose plan-splint final
wait splint-findings
click skin:off
picture 5-splint
)";

}  // namespace condyle
