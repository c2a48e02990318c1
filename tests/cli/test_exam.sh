#!/bin/sh
# From a phantom to a complete exam: every file there, every JSON readable, the same twice.
. "$(dirname "$0")/harness.sh"

maps="axial tangential elevation mean gaussian refractive sigma_z sigma_axial"

# check_pupil DIR SCENE...: the files of one pupil.
check_pupil() {
  pupil=$1
  shift
  have "$pupil/psf.csv" "$pupil/psf.json"
  [ "$(wc -l < "$pupil/psf.csv")" -eq 257 ] || fail "$pupil/psf.csv has not 257 rows"
  json "$pupil/psf.json" placido-psf/1 pupil_mm rays rays_entered rays_landed strehl_g bucket_arcmin bucket_um \
    correction.sphere_D correction.cylinder_D retina_mm refractive_index seconds
  for scene in "$@"; do
    have "$pupil/$scene.png"
  done
  [ "$FIGURES" = OFF ] || have "$pupil/psf.png"
}

# check_measured DIR: what exam and reconstruct both write.
check_measured() {
  have "$1/mires.csv" "$1/surface.json" "$1/maps.csv" "$1/indices.json"
  json "$1/surface.json" placido-surface/1 radius_mm parts
  json "$1/indices.json" placido-indices/1
  [ "$(head -n 1 "$1/mires.csv")" = edge,meridian_deg,u_px,v_px,sigma_px,used,residual_px ] ||
    fail "the columns of mires.csv"
  [ "$(head -n 1 "$1/maps.csv")" = x_mm,y_mm,valid,z_mm,elevation_um,axial_D,tangential_D,mean_D,gaussian_mm2,refractive_D,sigma_z_um,sigma_axial_D ] ||
    fail "the columns of maps.csv"
  for map in $maps; do
    [ "$FIGURES" = OFF ] || have "$1/maps/$map.png"
  done
}

exam_keys="software created input.path input.instrument settings.axis_z_mm settings.pupils_mm capture.frame
  capture.coverage fit.rms_px fit.points_used fit.error_budget.distance.z_um pupils seconds.mires seconds.total warnings"

echo "== an image"
succeed phantom --eye keratoconus --instrument cone24 -o eye.png --noise 1 --lashes 5 --json
json out.txt - output axis_z_mm
succeed exam eye.png --instrument eye.instrument.json --axis-z 0 --pupils 2.5,4 -o exam --timing
says '^mires +[0-9.]+' out.txt
says '^total +[0-9.]+' out.txt
check_measured exam
check_pupil exam/pupil-2.5mm tumbling-e
check_pupil exam/pupil-4mm tumbling-e
# shellcheck disable=SC2086
json exam/exam.json placido-exam/1 $exam_keys
says '"strehl_g_sigma": [0-9]' exam/exam.json
if [ "$FIGURES" = ON ]; then
  have exam/report.html exam/capture.png exam/mires.png
  says 'data:image/png;base64' exam/report.html
else
  have_not exam/report.html
  says 'draws no figures' err.txt
fi

echo "== the same again takes the place of the first, and measures the same with another number of threads"
cp exam/maps.csv maps.first
cp exam/pupil-4mm/psf.csv psf.first
succeed exam eye.png --instrument eye.instrument.json --axis-z 0 --pupils 4 --threads 1 --json -o exam
json out.txt placido-exam/1 directory indices command exit_code
have_not exam/pupil-2.5mm
cmp exam/maps.csv maps.first || fail "the maps depend on the number of threads"
cmp exam/pupil-4mm/psf.csv psf.first || fail "the PSF depends on the number of threads"

echo "== --quiet is quiet"
succeed exam eye.png --instrument eye.instrument.json --pupils 4 --quiet -o exam
[ ! -s out.txt ] && [ ! -s err.txt ] || fail "--quiet is not quiet"

echo "== parts"
succeed reconstruct eye.png --instrument eye.instrument.json --axis-z 0 -o cornea
check_measured cornea
have_not cornea/exam.json cornea/report.html
json cornea/reconstruction.json placido-reconstruction/1 capture.frame fit.rms_px warnings
succeed simulate cornea/surface.json --pupils 3 --scene tumbling-e -o seen
check_pupil seen/pupil-3mm tumbling-e
json seen/simulation.json placido-simulation/1 pupils seconds.total warnings
says '"strehl_g_sigma": null' seen/simulation.json
succeed simulate eye.surface.json --pupils 3 --retina 24 --correction -1,-0.5,30 -o seen
json seen/pupil-3mm/psf.json placido-psf/1 correction.axis_deg
succeed simulate eye.surface.json --pupils 3 --axial-length 25 --wear '-2 -0.5 30 @13' -o glasses
json glasses/simulation.json placido-simulation/1 pupils settings.axial_length_mm
says '"vertex_mm": 13' glasses/simulation.json

echo "== waves in place of rays, and through focus"
succeed simulate eye.surface.json --pupils 3 --diffraction 555 --through-focus 1 -o waves
check_pupil waves/pupil-3mm tumbling-e
says '"method": "diffraction"' waves/pupil-3mm/psf.json
json waves/pupil-3mm/psf.json placido-psf/1 wavelength_nm mtf encircled_50_arcmin encircled_80_arcmin
[ "$(wc -l <waves/pupil-3mm/focus.csv)" = 42 ] || fail "focus.csv has not 41 lenses"
[ "$FIGURES" = OFF ] || have waves/pupil-3mm/quality.png

echo "== a pupil that the surface does not fill is left out, and told"
succeed simulate cornea/surface.json --pupils 3,12 -o seen
says 'warning: pupil of 12 mm left out' err.txt
have_not seen/pupil-12mm
refuse 4 'no pupil can be simulated' simulate cornea/surface.json --pupils 12 -o nothing
# Charts are drawn as finely as the buckets ask for.
succeed simulate cornea/surface.json --pupils 3 --bucket 0.25 -o seen
have seen/pupil-3mm/tumbling-e.png

echo "== a distance that nobody measured is told"
succeed reconstruct eye.png --instrument eye.instrument.json -o cornea
says 'warning: the cornea.s distance was not measured' err.txt

if [ "$SESSIONS" = ON ]; then
  echo "== a session"
  succeed phantom --eye normal --instrument cone24 --frames 4 -o eye.session
  have eye.session/session.json eye.session/instrument.json eye.session/frames.mkv
  succeed reconstruct eye.session --json -o cornea
  json out.txt placido-reconstruction/1 capture.frames
  # Frame 1 is out of focus and frame 2 has the lid half closed: neither is the best.
  grep -Eq '"frame": *[03],?$' out.txt || fail "not the best frame was taken"
  grep -Eq '"frames": *4,?$' out.txt || fail "not every frame was looked at"
  succeed reconstruct replay:eye.session --frame 0 -o cornea
fi
finish
