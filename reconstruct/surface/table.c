/* The list of the kinds of part that a surface can be made of. */
#include "reconstruct/surface/part.h"

const placido_part_row *const placido_part_rows[PLACIDO_PART_KINDS] = {
    [PLACIDO_PART_BICONIC] = &placido_part_biconic,
    [PLACIDO_PART_BUMP] = &placido_part_bump,
    [PLACIDO_PART_ABLATION] = &placido_part_ablation,
    [PLACIDO_PART_ZERNIKE] = &placido_part_zernike,
    [PLACIDO_PART_RIDGE] = &placido_part_ridge,
    [PLACIDO_PART_BSPLINE] = &placido_part_bspline,
};
