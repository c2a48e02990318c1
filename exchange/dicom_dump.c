/* The data set of a Corneal Topography Map in the order of its modules (PS3.3, A.73.3), as text for
 * DCMTK's dump2dcm, a line an element; dump2dcm sorts them by tag. */
#include "exchange/dicom.h"

#include <math.h>
#include <string.h>

#define SOP_CLASS "1.2.840.10008.5.1.4.1.1.82.1"
#define SOURCE_CLASS "1.2.840.10008.5.1.4.1.1.77.1.5.1" /* Ophthalmic Photography 8 Bit Image */

/* A coded concept: value, scheme, meaning. */
struct code {
  const char *value, *scheme, *meaning;
};

static const struct code eye = {"81745001", "SCT", "Eye"};
static const struct code sides[2] = {{"24028007", "SCT", "Right"}, {"7771000", "SCT", "Left"}};
static const struct code dioptre = {"[diop]", "UCUM", "diopter"};
static const struct code axial_map = {"111940", "DCM", "Corneal axial power map"};
static const struct code cornea = {"28726007", "SCT", "Cornea"};
static const struct code derived_from = {"121322", "DCM",
                                         "Source image for image processing operation"};

/* An element of text; what could end it early is left out. */
static void put_text(FILE *stream, const char *tag, const char *type, const char *text) {
  fprintf(stream, "(%s) %s [", tag, type);
  for (; *text; text++) {
    if (!strchr("[]\\\r\n", *text)) {
      fputc(*text, stream);
    }
  }
  fputs("]\n", stream);
}

static void put_real(FILE *stream, const char *tag, const char *type, double value) {
  fprintf(stream, "(%s) %s %.*g\n", tag, type, strcmp(type, "FD") == 0 ? 17 : 9, value);
}

static void begin(FILE *stream, const char *tag) {
  fprintf(stream, "(%s) SQ\n(fffe,e000) na\n", tag);
}

static void end(FILE *stream) {
  fputs("(fffe,e00d) na\n(fffe,e0dd) na\n", stream);
}

static void put_empty(FILE *stream, const char *tag) {
  fprintf(stream, "(%s) SQ\n(fffe,e0dd) na\n", tag);
}

static void put_code_elements(FILE *stream, const struct code *code) {
  fprintf(stream, "(0008,0100) SH [%s]\n", code->value); /* UCUM's codes have brackets */
  put_text(stream, "0008,0102", "SH", code->scheme);
  put_text(stream, "0008,0104", "LO", code->meaning);
}

static void put_code(FILE *stream, const char *tag, const struct code *code) {
  begin(stream, tag);
  put_code_elements(stream, code);
  end(stream);
}

static const char *or_text(const char *text, const char *otherwise) {
  return text && text[0] ? text : otherwise;
}

static bool is_right(const placido_dicom_map *map) {
  return strcmp(map->info->eye, "OD") == 0;
}

static void put_patient_and_study(FILE *stream, const placido_dicom_map *map) {
  const char *id = or_text(map->info->patient_id, "ANONYMOUS");
  fprintf(stream, "(0010,0010) PN [%s^]\n", id); /* a family name */
  put_text(stream, "0010,0020", "LO", id);
  put_text(stream, "0010,0030", "DA", "");
  put_text(stream, "0010,0040", "CS", "");
  put_text(stream, "0020,000d", "UI", map->uids[PLACIDO_DICOM_STUDY]);
  put_text(stream, "0008,0020", "DA", map->date);
  put_text(stream, "0008,0030", "TM", map->time);
  put_text(stream, "0008,0090", "PN", "");
  put_text(stream, "0020,0010", "SH", "1");
  put_text(stream, "0008,0050", "SH", "");
}

static void put_series_and_equipment(FILE *stream, const placido_dicom_map *map) {
  const placido_dicom_info *info = map->info;
  put_text(stream, "0008,0060", "CS", "OPM");
  put_text(stream, "0020,000e", "UI", map->uids[PLACIDO_DICOM_SERIES]);
  put_text(stream, "0020,0011", "IS", "1");
  put_text(stream, "0018,0015", "CS", "EYE");
  put_text(stream, "0008,0070", "LO", or_text(info->maker, "unknown"));
  put_text(stream, "0008,1090", "LO", or_text(info->model, "unknown"));
  put_text(stream, "0018,1000", "LO", or_text(info->serial, "unknown"));
  put_text(stream, "0018,1020", "LO", or_text(info->software, "Placido"));
  put_text(stream, "0020,0052", "UI", map->uids[PLACIDO_DICOM_FRAME]);
  put_text(stream, "0020,1040", "LO", is_right(map) ? "CORNEAL_VERTEX_R" : "CORNEAL_VERTEX_L");
}

/* General Image, Image Pixel, Corneal Topography Map Image and SOP Common. */
static void put_image(FILE *stream, const placido_dicom_map *map) {
  fputs("(0008,0005) CS [ISO_IR 192]\n(0008,0016) UI [" SOP_CLASS "]\n", stream);
  put_text(stream, "0008,0018", "UI", map->uids[PLACIDO_DICOM_INSTANCE]);
  fputs("(0008,0008) CS [DERIVED\\PRIMARY\\CORNEAL_TOPO]\n(0020,0013) IS [1]\n"
        "(0020,0020) CS [L\\F]\n", stream);
  put_text(stream, "0008,0023", "DA", map->date);
  put_text(stream, "0008,0033", "TM", map->time);
  fprintf(stream, "(0008,002a) DT [%s%s+0000]\n(0008,0201) SH [+0000]\n", map->date, map->time);
  fprintf(stream, "(0028,0002) US 1\n(0028,0004) CS [PALETTE COLOR]\n(0028,0010) US %d\n"
          "(0028,0011) US %d\n(0028,0030) DS [%.6g\\%.6g]\n"
          "(0028,0034) IS [" PLACIDO_DICOM_ASPECT "]\n"
          "(0028,0100) US 16\n(0028,0101) US 16\n(0028,0102) US 15\n(0028,0103) US 0\n",
          map->rows, map->columns, PLACIDO_DICOM_PIXEL_Y_MM, PLACIDO_DICOM_PIXEL_X_MM);
  for (int k = 0; k < 3; k++) {
    fprintf(stream, "(0028,110%d) US %d\\0\\16\n(0028,120%d) OW =%s\n", k + 1,
            PLACIDO_DICOM_LEVELS, k + 1, placido_dicom_palettes[k]);
  }
  fputs("(0028,0301) CS [NO]\n(0028,0302) CS [YES]\n(0028,2110) CS [00]\n", stream);
  put_text(stream, "0020,0062", "CS", is_right(map) ? "R" : "L");
  fputs("(7fe0,0010) OW =" PLACIDO_DICOM_PIXELS "\n", stream);
}

/* What stored values mean, and of what part of the body. */
static void put_meaning(FILE *stream, const placido_dicom_map *map) {
  begin(stream, "0040,9096");
  put_text(stream, "0040,9210", "SH", "AXIAL_POWER");
  put_text(stream, "0028,3003", "LO", "Axial power, keratometric index 1.3375");
  fprintf(stream, "(0040,9216) US 1\n(0040,9211) US %d\n", PLACIDO_DICOM_LEVELS - 1);
  put_real(stream, "0040,9224", "FD", PLACIDO_DICOM_LEAST_D);
  put_real(stream, "0040,9225", "FD", PLACIDO_DICOM_STEP_D);
  put_code(stream, "0040,08ea", &dioptre);
  end(stream);
  begin(stream, "0008,2218");
  put_code_elements(stream, &eye);
  put_code(stream, "0008,2220", &sides[is_right(map) ? 0 : 1]);
  end(stream);
  put_code(stream, "0008,2228", &cornea);
}

/* Nobody commanded a movement, corrected a refraction or measured a pressure. */
static void put_acquisition(FILE *stream) {
  static const char *const empty[] = {"(0022,0005) CS []", "(0022,000a) FL", "(0022,000b) FL",
                                      "(0022,000c) FL", "(0022,000d) CS []"};
  for (size_t i = 0; i < sizeof empty / sizeof empty[0]; i++) {
    fprintf(stream, "%s\n", empty[i]);
  }
  put_empty(stream, "0022,001b");
  put_empty(stream, "0040,0555");
}

static void put_meridian(FILE *stream, const char *tag, double power_D, double axis_deg) {
  begin(stream, tag);
  put_real(stream, "0046,0075", "FD", 337.5 / power_D);
  put_real(stream, "0046,0076", "FD", power_D);
  put_real(stream, "0046,0077", "FD", axis_deg);
  end(stream);
}

static void put_if_known(FILE *stream, const char *tag, double value) {
  if (isfinite(value)) {
    put_real(stream, tag, "FL", value);
  }
}

static void put_analysis(FILE *stream, const placido_dicom_map *map) {
  const placido_dicom_figures *f = &map->figures;
  put_text(stream, "0022,1415", "CS", "REFLECTION");
  fprintf(stream, "(0046,0202) FL %.9g\\%.9g\n", map->centre_px[0], map->centre_px[1]);
  put_text(stream, "0046,0201", "CS", "A");
  put_real(stream, "0046,0203", "FL", 0);
  put_real(stream, "0046,0204", "FL", 0);
  put_real(stream, "0046,0205", "FL", PLACIDO_DICOM_PUPIL_MM);
  put_code(stream, "0046,0207", &axial_map);
  if (isfinite(f->peak_D + f->peak_mm[0] + f->peak_mm[1])) {
    begin(stream, "0046,0211");
    put_real(stream, "0046,0212", "FL", f->peak_D);
    fprintf(stream, "(0046,0213) FL %.9g\\%.9g\n", f->peak_mm[0] - f->vertex_mm[0],
            f->peak_mm[1] - f->vertex_mm[1]);
    end(stream);
  }
  put_meridian(stream, "0046,0074", f->steep_D, f->steep_deg);
  put_meridian(stream, "0046,0080", f->flat_D, f->flat_deg);
  put_meridian(stream, "0046,0215", f->least_D, f->least_deg);
  begin(stream, "0046,0218");
  put_real(stream, "0046,0147", "FD", f->steep_D - f->flat_D);
  put_real(stream, "0022,0009", "FL", f->steep_deg);
  put_real(stream, "0046,0076", "FD", f->steep_D - f->flat_D);
  put_real(stream, "0046,0077", "FD", f->steep_deg);
  end(stream);
  put_real(stream, "0046,0220", "FL", f->average_D);
  put_real(stream, "0046,0224", "FL", f->inferior_superior_D);
  put_real(stream, "0046,0227", "FL", f->area_mm2);
  put_if_known(stream, "0046,0234", f->eccentricity);
  put_if_known(stream, "0046,0236", f->kpi);
}

/* The picture that the mires were seen in, which is not sent along. */
static void put_source(FILE *stream, const placido_dicom_map *map) {
  begin(stream, "0008,2112");
  fputs("(0008,1150) UI [" SOURCE_CLASS "]\n", stream);
  put_text(stream, "0008,1155", "UI", map->uids[PLACIDO_DICOM_SOURCE]);
  put_code(stream, "0040,a170", &derived_from);
  end(stream);
}

static void put_point(FILE *stream, const placido_dicom_map *map, int i, int j) {
  static const struct {
    const char *tag, *map;
  } powers[] = {{"0046,0249", "axial"},
                {"0046,0250", "tangential"},
                {"0046,0251", "refractive"},
                {"0046,0252", "elevation"}};
  const placido_maps *m = &map->points;
  const double *vertex = map->figures.vertex_mm;
  size_t at = (size_t)j * (size_t)m->size + (size_t)i;
  double values[4], sum = map->wavefront_um[at];
  for (int k = 0; k < 4; k++) {
    values[k] = m->values[placido_maps_find(powers[k].map)][at];
    sum += values[k];
  }
  if (!m->valid[at] || !isfinite(sum)) {
    return;
  }
  fprintf(stream, "(fffe,e000) na\n(0046,0247) FL %.9g\\%.9g\\%.9g\n(0046,0248) CS [NO]\n",
          placido_maps_position(m, i) - vertex[0], placido_maps_position(m, j) - vertex[1],
          m->z_mm[at] - vertex[2]);
  for (int k = 0; k < 4; k++) {
    put_real(stream, powers[k].tag, "FL", values[k]);
  }
  put_real(stream, "0046,0253", "FL", map->wavefront_um[at]);
  fputs("(fffe,e00d) na\n", stream);
}

void placido_dicom_dump(FILE *stream, const placido_dicom_map *map) {
  put_image(stream, map);
  put_patient_and_study(stream, map);
  put_series_and_equipment(stream, map);
  put_meaning(stream, map);
  put_acquisition(stream);
  put_analysis(stream, map);
  put_source(stream, map);
  fputs("(0046,0244) SQ\n", stream);
  for (int j = 0; j < map->points.size; j++) {
    for (int i = 0; i < map->points.size; i++) {
      put_point(stream, map, i, j);
    }
  }
  fputs("(fffe,e0dd) na\n", stream);
}
