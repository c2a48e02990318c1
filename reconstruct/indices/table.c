/* The list of the indices, in the order of indices.json. */
#include "reconstruct/indices/cornea.h"

static const placido_index_group *const groups[] = {
    &placido_vertex_group,      &placido_simk_group,       &placido_power_group,
    &placido_asphericity_group, &placido_meridian_group,   &placido_sphere_group,
    &placido_steepest_group,    &placido_rabinowitz_group, &placido_clmi_group,
    &placido_regularity_group,  &placido_sector_group,
};

const placido_index_group *const *placido_index_groups(size_t *count) {
  *count = sizeof groups / sizeof groups[0];
  return groups;
}
