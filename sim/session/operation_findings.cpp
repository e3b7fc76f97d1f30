#include "sim/session/operation_findings.h"

#include "sim/operation/graft_steps.h"

namespace condyle {

OperationFindings find_in_grafts(const Operated& operated) {
  OperationFindings findings;
  for (const GraftLayout& graft : operated.grafts)
    findings.grafts[graft.step.name] = graft_sentences(operated, graft);
  return findings;
}

OperationFindings find_in_operation(const Operated& operated) {
  OperationFindings findings = find_in_grafts(operated);
  findings.overlaps = segment_overlaps(operated);
  return findings;
}

}  // namespace condyle
