#include "sim/session/operation_findings.h"

#include "sim/operation/graft_steps.h"

namespace condyle {

OperationFindings find_in_operation(const Operated& operated) {
  OperationFindings findings{.overlaps = segment_overlaps(operated)};
  for (const GraftLayout& graft : operated.grafts)
    findings.grafts[graft.step.name] = graft_sentences(operated, graft);
  return findings;
}

}  // namespace condyle
