// What one stage counts and later stages and the host read. totals.h names the same places.
layout(std430, binding = TOTALS_BINDING) buffer Totals {
  uint cut_nodes, cut_entries, cut_whole;  // nodes; all; where whole nodes' surfels begin
  uint nearest, farthest;  // bits of the splats' distances
  uint list_entries;
  uint splats;
  uint work[3];            // work items: unblurred, whole aperture, sub-apertures
  uint fragments_low, fragments_high;
  uint longest_list, sweep_rounds;  // the most of a tile, and of a sample
  uint unused[2];
  uvec4 project_groups;    // numbers of work groups of indirect dispatches
  uvec4 sweep_groups[3];
};
