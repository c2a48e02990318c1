/* A veil in coarse cells: light is gathered at their corners by hat functions, spread from corner
 * to corner by the glare function, and interpolated between them.
 *
 * What is spread is light less its mean: the even rest of it, and all that comes from beyond the
 * picture, is share times mean. Hats of 2' move none of a source's light on the average, and make a
 * veil half a degree away about 1 % stronger. */
#include "simulate/models/veil.h"

#include "base/dispatch.h"
#include "base/memory.h"
#include "simulate/eye.h"

#include <placido/convolution.h>

#include <math.h>
#include <string.h>

static int larger(int a, int b) { return a > b ? a : b; }

/* The part of the picture that is looked at. */
typedef struct extent {
  int width, height;
} extent;

static extent extent_of(const placido_image *image, int margin_px) {
  return (extent){image->width_px - 2 * margin_px, image->height_px - 2 * margin_px};
}

static const float *row_of(const placido_image *image, int plane, int margin_px, int y) {
  return placido_image_plane(image, plane) +
         (size_t)(y + margin_px) * (size_t)image->width_px + (size_t)margin_px;
}

static void choose_cells(placido_veil *veil, const extent *size, double arcmin_per_px) {
  int longer = larger(size->width, size->height);
  int fine = (int)fmax(round(PLACIDO_VEIL_CELL_ARCMIN / arcmin_per_px), 1);
  int least = (longer + PLACIDO_VEIL_CELLS_MAX - 1) / PLACIDO_VEIL_CELLS_MAX;
  veil->cell_px = larger(fine, least);
  veil->columns = (size->width + veil->cell_px - 1) / veil->cell_px + 1;
  veil->rows = (size->height + veil->cell_px - 1) / veil->cell_px + 1;
}

/* A row's light in excess of `level` to the lines above and below it, by how near they are. */
PLACIDO_WIDE static void add_row(float *restrict above, float *restrict below,
                                 const float *restrict row, int width, float level, float down) {
#pragma omp simd
  for (int x = 0; x < width; x++) {
    const float excess = row[x] - level;
    above[x] += (1 - down) * excess;
    below[x] += down * excess;
  }
}

/* A line's light at the corners of a row of cells. */
static void gather_line(double *corners, const float *line, int width, int cell_px) {
  for (int first = 0, k = 0; first < width; first += cell_px, k++) {
    int end = first + cell_px < width ? first + cell_px : width;
    double all = 0, far = 0;
    for (int x = first; x < end; x++) {
      all += (double)line[x];
      far += (double)line[x] * (x - first + 0.5);
    }
    far /= cell_px;
    corners[k] += all - far;
    corners[k + 1] += far;
  }
}

/* `lines` has room for two. */
static void gather(double *corners, float *lines, const placido_veil *veil,
                   const placido_image *light, int plane, float level) {
  const extent size = extent_of(light, veil->margin_px);
  float *below = lines + size.width;
  for (int first = 0; first < size.height; first += veil->cell_px) {
    memset(lines, 0, 2 * (size_t)size.width * sizeof *lines);
    for (int y = first; y < size.height && y < first + veil->cell_px; y++) {
      float down = ((float)(y - first) + 0.5f) / (float)veil->cell_px;
      add_row(lines, below, row_of(light, plane, veil->margin_px, y), size.width, level, down);
    }
    double *above = corners + (size_t)(first / veil->cell_px) * (size_t)veil->columns;
    gather_line(above, lines, size.width, veil->cell_px);
    gather_line(above + veil->columns, below, size.width, veil->cell_px);
  }
}

/* How many pixels' light the corner `index` of a side gets where light is even. */
static double pixels_of(int index, int length_px, int cell_px) {
  double sum = 0;
  if (index > 0 && (index + 1) * cell_px <= length_px) {
    return cell_px;
  }
  for (int i = -cell_px; i < cell_px; i++) {
    int at = index * cell_px + i;
    sum += at >= 0 && at < length_px ? 1 - fabs(i + 0.5) / cell_px : 0;
  }
  return sum;
}

/* Light less its mean. It is gathered less a sample of it, so that nothing is left where all are
 * alike; what the corners have in all then tells the mean. */
static void gather_excess(double *corners, float *lines, placido_veil *veil,
                          const placido_image *light, int plane) {
  const extent size = extent_of(light, veil->margin_px);
  const float level = row_of(light, plane, veil->margin_px, 0)[0];
  double sum = 0;
  gather(corners, lines, veil, light, plane, level);
  for (int i = 0; i < veil->columns * veil->rows; i++) {
    sum += corners[i];
  }
  const double excess = sum / ((double)size.width * size.height);
  veil->mean[plane] = (double)level + excess;
  for (int row = 0; row < veil->rows; row++) {
    double height = pixels_of(row, size.height, veil->cell_px);
    for (int k = 0; k < veil->columns; k++) {
      *corners++ -= excess * height * pixels_of(k, size.width, veil->cell_px);
    }
  }
}

/* What a pixel's light gives at whole cells from it, in an eighth of the plane and its images. */
static void fill_kernel(placido_psf *kernel, const placido_glare *glare, double cell_arcmin,
                        double arcmin_per_px, int threads) {
  const double pixel = arcmin_per_px * PLACIDO_ARCMIN_RAD;
  const size_t n = (size_t)kernel->n, middle = n / 2;
#pragma omp parallel for num_threads(threads) schedule(static, 8)
  for (int y = 0; y <= kernel->n / 2; y++) {
    for (int x = 0; x <= y; x++) {
      double angle_deg = hypot(x, y) * cell_arcmin / 60;
      double value = placido_glare_veil(glare, angle_deg) * pixel * pixel;
      const size_t near = (size_t)x, far = (size_t)y;
      for (int image = 0; image < 8; image++) {
        size_t column = image & 1 ? near : far, row = image & 1 ? far : near;
        column = image & 2 ? middle - column : middle + column;
        row = image & 4 ? middle - row : middle + row;
        kernel->values[row * n + column] = value;
      }
    }
  }
}

static int convolve(placido_veil *veil, const float *gathered, const placido_psf *kernel,
                    int threads, placido_error *err) {
  const placido_convolution how = {.threads = threads};
  const size_t corners = (size_t)veil->columns * (size_t)veil->rows;
  placido_convolver *convolver;
  placido_transfer *transfer = NULL;
  placido_convolution_term terms[PLACIDO_VEIL_PLANES];
  placido_superposition planes[PLACIDO_VEIL_PLANES];
  int status = placido_convolver_new(&convolver, veil->columns, veil->rows, kernel->n / 2, &how,
                                     NULL, err);
  if (status == PLACIDO_OK) {
    status = placido_transfer_new(&transfer, convolver, kernel, err);
  }
  for (int i = 0; i < veil->planes; i++) {
    terms[i] = (placido_convolution_term){gathered + (size_t)i * corners, transfer};
    planes[i] = (placido_superposition){veil->excess + (size_t)i * corners, &terms[i], 1};
  }
  if (status == PLACIDO_OK) {
    status = placido_convolver_run(convolver, planes, (size_t)veil->planes, err);
  }
  placido_transfer_free(transfer);
  placido_convolver_free(convolver);
  return status;
}

/* What making a veil takes: light at the corners, in which precision it is gathered and spread. */
typedef struct work {
  double *gathered;
  float *source, *lines;
  placido_psf kernel;
} work;

static int allocate(work *w, placido_veil *veil, int width, placido_error *err) {
  const size_t corners = (size_t)veil->columns * (size_t)veil->rows;
  const size_t samples = (size_t)veil->planes * corners, n = (size_t)w->kernel.n;
  w->gathered = placido_memory_new(samples, sizeof *w->gathered, err);
  w->source = w->gathered != NULL ? placido_memory_new(samples, sizeof *w->source, err) : NULL;
  veil->excess = w->source != NULL ? placido_memory_new(samples, sizeof *veil->excess, err) : NULL;
  w->lines = veil->excess != NULL ? placido_memory_new(2 * (size_t)width * (size_t)veil->planes,
                                                       sizeof *w->lines, err)
                                  : NULL;
  if (w->lines != NULL) {
    w->kernel.values = placido_memory_new(n * n, sizeof *w->kernel.values, err);
  }
  return w->kernel.values != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
}

static void gather_plane(const work *w, placido_veil *veil, const placido_image *light,
                         int plane) {
  const size_t corners = (size_t)veil->columns * (size_t)veil->rows;
  const size_t first = corners * (size_t)plane;
  float *lines = w->lines + 2 * (size_t)plane * (size_t)extent_of(light, veil->margin_px).width;
  gather_excess(w->gathered + first, lines, veil, light, plane);
  for (size_t i = first; i < first + corners; i++) {
    w->source[i] = (float)w->gathered[i];
  }
}

int placido_veil_new(placido_veil *veil, const placido_image *light, int margin_px,
                     double arcmin_per_px, const placido_glare *glare, int threads,
                     placido_error *err) {
  const extent size = extent_of(light, margin_px);
  *veil = (placido_veil){.share = placido_glare_veil_share(glare),
                         .margin_px = margin_px, .planes = light->planes};
  choose_cells(veil, &size, arcmin_per_px);
  work w = {.kernel = {.n = 2 * larger(veil->columns, veil->rows) - 1}};
  int status = allocate(&w, veil, size.width, err);
  if (status == PLACIDO_OK) {
#pragma omp parallel for num_threads(threads)
    for (int plane = 0; plane < light->planes; plane++) {
      gather_plane(&w, veil, light, plane);
    }
    fill_kernel(&w.kernel, glare, veil->cell_px * arcmin_per_px, arcmin_per_px, threads);
    status = convolve(veil, w.source, &w.kernel, threads, err);
  }
  placido_memory_free(w.kernel.values);
  placido_memory_free(w.lines);
  placido_memory_free(w.source);
  placido_memory_free(w.gathered);
  if (status != PLACIDO_OK) {
    placido_veil_free(veil);
  }
  return status;
}

void placido_veil_free(placido_veil *veil) {
  placido_memory_free(veil->excess);
  *veil = (placido_veil){.excess = NULL};
}

/* Samples from `first` to before `end`: the share of each that goes elsewhere is replaced by the
 * mean's, and an excess that changes by `slope` from one to the next is laid over. Samples that are
 * the mean stay, bit for bit. */
PLACIDO_INSIDE void lay(float *row, int first, int end, float share, float mean, float excess,
                        float slope) {
  for (int x = first; x < end; x++) {
    row[x] += share * (mean - row[x]) + excess + slope * (float)(x - first);
  }
}

/* A row of samples beside a row of cells: it lies `down` cells below the corners `above`. Beyond
 * the outermost corners the veil goes on. */
PLACIDO_WIDE static void lay_row(float *row, int width, const placido_veil *veil, int plane,
                                 const float *above, float down) {
  const float share = (float)veil->share, mean = (float)veil->mean[plane];
  const float *below = above + veil->columns;
  const int last = veil->columns - 1, cell_px = veil->cell_px;
  float here = (1 - down) * above[0] + down * below[0];
  lay(row, 0, veil->margin_px, share, mean, here, 0);
  for (int k = 0, x = veil->margin_px; k < last; k++, x += cell_px) {
    const float next = (1 - down) * above[k + 1] + down * below[k + 1];
    const float slope = (next - here) / (float)cell_px;
    const int end = x + cell_px < width ? x + cell_px : width;
    lay(row, x, end, share, mean, here + 0.5f * slope, slope);
    here = next;
  }
  const int covered = veil->margin_px + last * cell_px;
  lay(row, covered, width, share, mean, here, 0);
}

static void lay_plane_row(placido_image *picture, const placido_veil *veil, int plane, int y) {
  const size_t columns = (size_t)veil->columns, corners = columns * (size_t)veil->rows;
  double at = fmin(fmax((y - veil->margin_px + 0.5) / veil->cell_px, 0), veil->rows - 1);
  int k = (int)at < veil->rows - 2 ? (int)at : veil->rows - 2;
  lay_row(placido_image_plane(picture, plane) + (size_t)y * (size_t)picture->width_px,
          picture->width_px, veil, plane,
          veil->excess + (size_t)plane * corners + (size_t)k * columns, (float)(at - k));
}

void placido_veil_lay(placido_image *picture, const placido_veil *veil, int threads) {
#pragma omp parallel for num_threads(threads)
  for (int y = 0; y < picture->height_px; y++) {
    for (int plane = 0; plane < veil->planes; plane++) {
      lay_plane_row(picture, veil, plane, y);
    }
  }
}
