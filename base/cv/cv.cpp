// OpenCV behind a C interface: the one place that sees C++; no exception leaves it.
extern "C" {
#include "base/cv/cv.h"

#include "base/cv/quiet.h"
#include "base/file.h"
#include "base/image_check.h"
#include "base/memory.h"
#include "base/text.h"
}

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <mutex>
#include <new>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace {

// Runs `work` (which returns a status) and turns exceptions into statuses.
template <typename Work>
int guarded(const char *what, placido_error *err, Work work) {
  try {
    return work();
  } catch (const std::bad_alloc &) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory: %s", what);
  } catch (const cv::Exception &cause) {
    if (cause.code == cv::Error::StsNoMem) {
      return placido_error_set(err, PLACIDO_MEMORY, "out of memory: %s", what);
    }
    return placido_error_set(err, PLACIDO_INPUT, "%s: %s", what, cause.err.c_str());
  } catch (const std::exception &cause) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %s", what, cause.what());
  }
}

// While it lives, OpenCV is silent: imdecode reports what it catches on std::cerr, whatever the log
// level. The lock keeps two decoders from restoring each other's buffer.
class Silence {
public:
  Silence()
      : lock_(mutex()), level_(cv::utils::logging::setLogLevel(
                            cv::utils::logging::LOG_LEVEL_SILENT)),
        buffer_(std::cerr.rdbuf(nullptr)) {}
  ~Silence() {
    std::cerr.rdbuf(buffer_);
    cv::utils::logging::setLogLevel(level_);
  }
  Silence(const Silence &) = delete;
  Silence &operator=(const Silence &) = delete;

private:
  static std::mutex &mutex() {
    static std::mutex shared;
    return shared;
  }
  std::lock_guard<std::mutex> lock_;
  cv::utils::logging::LogLevel level_;
  std::streambuf *buffer_;
};

// Decodes with nothing printed. False where the decoder met damage that it covers up: libjpeg goes
// on behind lost data and leaves grey.
bool decode_quietly(cv::Mat &decoded, const cv::Mat &bytes, int flags) {
  Silence silence;
  placido_quiet quiet;
  char said[4096];
  placido_quiet_begin(&quiet);
  try {
    decoded = cv::imdecode(bytes, flags);
  } catch (...) {
    placido_quiet_end(&quiet, said, sizeof said);
    throw;
  }
  placido_quiet_end(&quiet, said, sizeof said);
  return !std::strstr(said, "Corrupt JPEG data") && !std::strstr(said, "Premature end of JPEG");
}

// A file's bytes, freed with the scope.
class Bytes {
public:
  Bytes() = default;
  ~Bytes() { placido_memory_free(text); }
  Bytes(const Bytes &) = delete;
  Bytes &operator=(const Bytes &) = delete;
  char *text = nullptr;
  size_t size = 0;
};

// Decodes a file to 1, 3 or 4 channels of 8 or 16 bit or 32-bit floating point, blue before red.
int decode(cv::Mat &decoded, placido_image_kind &kind, const char *path, placido_error *err) {
  Bytes bytes;
  int status = placido_file_read(&bytes.text, &bytes.size, path, 0, err);
  if (!status) {
    status = placido_image_check(&kind, reinterpret_cast<unsigned char *>(bytes.text), bytes.size,
                                 path, err);
  }
  if (status) {
    return status;
  }
  // IMREAD_UNCHANGED keeps alpha and loses the EXIF orientation, the other flags the reverse.
  const int flags = kind.alpha || kind.keeps_own_orientation
                        ? cv::IMREAD_UNCHANGED
                        : cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR;
  const cv::Mat all(1, static_cast<int>(bytes.size), CV_8U, bytes.text);
  const char *name = placido_text_tail(path);
  if (!decode_quietly(decoded, all, flags)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: the JPEG file is cut off or damaged", name);
  }
  if (decoded.empty()) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: the image cannot be decoded", name);
  }
  const int channels = decoded.channels();
  const int depth = decoded.depth();
  if ((depth != CV_8U && depth != CV_16U && depth != CV_32F) ||
      (channels != 1 && channels != 3 && channels != 4)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s: samples of 8 or 16 bit in 1, 3 or 4 channels are expected", name);
  }
  return PLACIDO_OK;
}

// The sample value of white.
double white_of(const cv::Mat &decoded, const placido_image_kind &kind) {
  // OpenCV stretches 8-bit PNM to the full range itself, and leaves 16-bit PNM as it is.
  if (decoded.depth() == CV_16U) {
    return kind.full_scale > 0 ? kind.full_scale : 65535;
  }
  return decoded.depth() == CV_32F ? 1 : 255;
}

cv::Mat plane_of(const placido_image *image, int plane) {
  return cv::Mat(image->height_px, image->width_px, CV_32F, placido_image_plane(image, plane));
}

int fill_image(placido_image *image, const cv::Mat &decoded, double white, placido_error *err) {
  const int channels = decoded.channels();
  const int status = placido_image_new(image, decoded.cols, decoded.rows, channels, err);
  if (status) {
    return status;
  }
  const int red_first[4] = {channels == 1 ? 0 : 2, 1, 0, 3};
  cv::Mat channel;
  for (int i = 0; i < channels; i++) {
    cv::extractChannel(decoded, channel, red_first[i]);
    channel.convertTo(plane_of(image, i), CV_32F, 1 / white);
  }
  return PLACIDO_OK;
}

// Gives the colours back what multiplying them by alpha took. libtiff multiplies 8-bit samples
// itself where the file has not.
void divide_by_alpha(placido_image *image) {
  const cv::Mat alpha = plane_of(image, 3);
  for (int i = 0; i < 3; i++) {
    cv::Mat colour = plane_of(image, i);
    cv::divide(colour, alpha, colour);
    colour.setTo(0, alpha <= 0);
  }
}

int fill_frame(placido_frame *frame, const cv::Mat &decoded, const placido_image_kind &kind,
               placido_error *err) {
  const bool wide = decoded.depth() == CV_16U;
  const placido_format format = decoded.channels() > 1 ? PLACIDO_RGB8
                                : wide                 ? PLACIDO_MONO16
                                                       : PLACIDO_MONO8;
  const int status = placido_frame_resize(frame, decoded.cols, decoded.rows, format, err);
  if (status) {
    return status;
  }
  const int type = format == PLACIDO_RGB8 ? CV_8UC3 : wide ? CV_16U : CV_8U;
  cv::Mat target(decoded.rows, decoded.cols, type, frame->data, frame->stride_bytes);
  if (format == PLACIDO_RGB8) {
    cv::Mat narrow = decoded;
    if (wide) {
      decoded.convertTo(narrow, CV_8U, 255 / white_of(decoded, kind));
    }
    cv::cvtColor(narrow, target, narrow.channels() == 4 ? cv::COLOR_BGRA2RGB : cv::COLOR_BGR2RGB);
  } else {
    decoded.copyTo(target);
  }
  if (format == PLACIDO_MONO16) {
    while (frame->bits > 8 && (1 << (frame->bits - 1)) > white_of(decoded, kind)) {
      frame->bits--;
    }
  }
  return PLACIDO_OK;
}

int check_same_planes(const placido_image *target, const placido_image *source,
                      placido_error *err) {
  if (target->planes != source->planes) {
    return placido_error_set(err, PLACIDO_INPUT, "resampling %d planes into %d", source->planes,
                             target->planes);
  }
  return PLACIDO_OK;
}

int interpolation_of(placido_cv_sampling sampling) {
  switch (sampling) {
  case PLACIDO_CV_CUBIC:
    return cv::INTER_CUBIC;
  case PLACIDO_CV_AREA:
    return cv::INTER_AREA;
  default:
    return cv::INTER_LINEAR;
  }
}

int write_bytes(const std::vector<unsigned char> &bytes, const char *path, placido_error *err) {
  errno = 0;
  FILE *stream = std::fopen(path, "wb");
  bool written = stream && std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size();
  if (stream && std::fclose(stream) != 0) {
    written = false;
  }
  if (!written) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", placido_text_tail(path),
                             std::strerror(errno));
  }
  return PLACIDO_OK;
}

} // namespace

int placido_cv_load(placido_image *image, int *bits, const char *path, placido_error *err) {
  *image = placido_image{};
  *bits = 0;
  const int status = guarded(placido_text_tail(path), err, [&] {
    cv::Mat decoded;
    placido_image_kind kind;
    int step = decode(decoded, kind, path, err);
    if (!step) {
      *bits = static_cast<int>(decoded.elemSize1()) * 8;
      step = fill_image(image, decoded, white_of(decoded, kind), err);
      const bool tiff = kind.keeps_own_orientation;
      if (!step && decoded.channels() == 4 && tiff && (*bits == 8 || kind.multiplied)) {
        divide_by_alpha(image);
      }
    }
    return step;
  });
  if (status) {
    placido_image_free(image);
  }
  return status;
}

int placido_cv_load_frame(placido_frame *frame, const char *path, placido_error *err) {
  return guarded(placido_text_tail(path), err, [&] {
    cv::Mat decoded;
    placido_image_kind kind;
    int status = decode(decoded, kind, path, err);
    if (!status && decoded.depth() == CV_32F) {
      status = placido_error_set(err, PLACIDO_INPUT,
                                 "%s: a frame has samples of 8 or 16 bit, not floating point",
                                 placido_text_tail(path));
    }
    return status ? status : fill_frame(frame, decoded, kind, err);
  });
}

int placido_cv_save_png(const void *samples, int width_px, int height_px, int channels, int bits,
                        size_t stride_bytes, const char *path, placido_error *err) {
  return guarded(placido_text_tail(path), err, [&] {
    const cv::Mat source(height_px, width_px, CV_MAKETYPE(bits > 8 ? CV_16U : CV_8U, channels),
                         const_cast<void *>(samples), stride_bytes);
    cv::Mat blue_first; // its own memory: the samples are the caller's
    if (channels >= 3) {
      cv::cvtColor(source, blue_first, channels == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGRA);
    } else {
      blue_first = source;
    }
    std::vector<unsigned char> bytes;
    bool encoded;
    {
      Silence silence;
      encoded = cv::imencode(".png", blue_first, bytes);
    }
    if (!encoded) {
      return placido_error_set(err, PLACIDO_INPUT, "%s: the image cannot be encoded",
                               placido_text_tail(path));
    }
    return write_bytes(bytes, path, err);
  });
}

int placido_cv_resize(placido_image *target, const placido_image *source,
                      enum placido_cv_sampling sampling, placido_error *err) {
  return guarded("resizing an image", err, [&] {
    const int status = check_same_planes(target, source, err);
    for (int i = 0; !status && i < source->planes; i++) {
      cv::Mat plane = plane_of(target, i);
      cv::resize(plane_of(source, i), plane, plane.size(), 0, 0, interpolation_of(sampling));
    }
    return status;
  });
}

int placido_cv_remap(placido_image *target, const placido_image *source, const float *map_x,
                     const float *map_y, enum placido_cv_sampling sampling, float border,
                     placido_error *err) {
  return guarded("remapping an image", err, [&] {
    const int status = check_same_planes(target, source, err);
    const cv::Mat x(target->height_px, target->width_px, CV_32F, const_cast<float *>(map_x));
    const cv::Mat y(target->height_px, target->width_px, CV_32F, const_cast<float *>(map_y));
    const int interpolation =
        sampling == PLACIDO_CV_CUBIC ? cv::INTER_CUBIC : cv::INTER_LINEAR;
    for (int i = 0; !status && i < source->planes; i++) {
      cv::Mat plane = plane_of(target, i);
      cv::remap(plane_of(source, i), plane, x, y, interpolation, cv::BORDER_CONSTANT,
                cv::Scalar::all(border));
    }
    return status;
  });
}

int placido_cv_undistort(double *normalised_xy, const double *image_uv, size_t count,
                         const double focal_px[2], const double principal_px[2],
                         const double distortion[5], placido_error *err) {
  return guarded("undistorting points", err, [&] {
    if (count == 0) {
      return static_cast<int>(PLACIDO_OK);
    }
    const cv::Matx33d camera(focal_px[0], 0, principal_px[0], 0, focal_px[1], principal_px[1], 0, 0,
                             1);
    const cv::Mat terms(1, 5, CV_64F, const_cast<double *>(distortion));
    const cv::Mat source(static_cast<int>(count), 1, CV_64FC2, const_cast<double *>(image_uv));
    cv::Mat target(static_cast<int>(count), 1, CV_64FC2, normalised_xy);
    // OpenCV's default of 5 rounds leaves 1e-3 px at the corners of a strongly distorted image.
    const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-12);
    cv::undistortPoints(source, target, camera, terms, cv::noArray(), cv::noArray(), until);
    return static_cast<int>(PLACIDO_OK);
  });
}

int placido_cv_blur(placido_image *image, double sigma_x_px, double sigma_y_px,
                    placido_error *err) {
  return guarded("blurring an image", err, [&] {
    for (int i = 0; i < image->planes; i++) {
      cv::Mat plane = plane_of(image, i);
      cv::GaussianBlur(plane, plane, cv::Size(), sigma_x_px, sigma_y_px, cv::BORDER_REFLECT_101);
    }
    return static_cast<int>(PLACIDO_OK);
  });
}
