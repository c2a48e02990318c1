// OpenCV's highgui behind a C interface; no exception leaves it.
extern "C" {
#include "base/cv/window/window.h"
}

#include <algorithm>
#include <fcntl.h>
#include <new>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

#include <opencv2/core.hpp>
#include <opencv2/highgui.hpp>
#include <opencv2/imgproc.hpp>

struct placido_window {
  std::string title;
  cv::Mat picture; // blue before red
  double scale = 1; // window's pixels in one of the frame's
};

namespace {

constexpr int LONGEST_SIDE = 1280;
constexpr int SUBPIXEL_BITS = 4;

// Runs `work` (which returns a status) and turns exceptions into statuses.
template <typename Work>
int guarded(placido_error *err, Work work) {
  try {
    return work();
  } catch (const std::bad_alloc &) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory: the window's picture");
  } catch (const cv::Exception &cause) {
    return placido_error_set(err, PLACIDO_INPUT, "the window: %s", cause.err.c_str());
  } catch (const std::exception &cause) {
    return placido_error_set(err, PLACIDO_INPUT, "the window: %s", cause.what());
  }
}

// Tries it in a process of its own: without a display some of highgui's backends abort.
bool can_open() {
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    dup2(nowhere, STDOUT_FILENO);
    try {
      cv::namedWindow("placido", cv::WINDOW_AUTOSIZE);
    } catch (...) {
      _exit(1);
    }
    _exit(0);
  }
  int end = 1;
  return child > 0 && waitpid(child, &end, 0) == child && WIFEXITED(end) && WEXITSTATUS(end) == 0;
}

cv::Scalar colour_of(placido_window_ink ink) {
  return cv::Scalar(ink.blue, ink.green, ink.red);
}

cv::Point place_of(const placido_window *window, const double px[2]) {
  const double scale = window->scale * (1 << SUBPIXEL_BITS);
  return cv::Point(cvRound(px[0] * scale), cvRound(px[1] * scale));
}

cv::Mat grey_of(const placido_frame *frame) {
  const cv::Mat samples(frame->height_px, frame->width_px,
                        frame->format == PLACIDO_MONO16 ? CV_16U : CV_8U, frame->data,
                        frame->stride_bytes);
  cv::Mat narrow = samples;
  if (frame->format == PLACIDO_MONO16) {
    samples.convertTo(narrow, CV_8U, 255.0 / ((1 << frame->bits) - 1));
  }
  return narrow;
}

cv::Mat colours_of(const placido_frame *frame) {
  cv::Mat picture;
  if (frame->format == PLACIDO_RGB8) {
    const cv::Mat samples(frame->height_px, frame->width_px, CV_8UC3, frame->data,
                          frame->stride_bytes);
    cv::cvtColor(samples, picture, cv::COLOR_RGB2BGR);
  } else {
    cv::cvtColor(grey_of(frame), picture, cv::COLOR_GRAY2BGR);
  }
  return picture;
}

} // namespace

int placido_window_open(placido_window **window, const char *title, placido_error *err) {
  *window = nullptr;
  if (!can_open()) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "no window can be opened: there is no display here");
  }
  const int status = guarded(err, [&] {
    *window = new placido_window;
    (*window)->title = title;
    cv::namedWindow((*window)->title, cv::WINDOW_AUTOSIZE);
    return static_cast<int>(PLACIDO_OK);
  });
  if (status) {
    placido_window_close(*window);
    *window = nullptr;
  }
  return status;
}

void placido_window_close(placido_window *window) {
  if (window) {
    guarded(nullptr, [&] {
      cv::destroyAllWindows();
      return static_cast<int>(PLACIDO_OK);
    });
    delete window;
  }
}

int placido_window_frame(placido_window *window, const placido_frame *frame, placido_error *err) {
  return guarded(err, [&] {
    const int side = std::max(frame->width_px, frame->height_px);
    window->scale = side > LONGEST_SIDE ? static_cast<double>(LONGEST_SIDE) / side : 1;
    window->picture = colours_of(frame);
    if (window->scale < 1) {
      cv::resize(window->picture, window->picture, cv::Size(), window->scale, window->scale,
                 cv::INTER_AREA);
    }
    return static_cast<int>(PLACIDO_OK);
  });
}

void placido_window_dot(placido_window *window, double u_px, double v_px,
                        placido_window_ink ink) {
  guarded(nullptr, [&] {
    const double place_px[2] = {u_px, v_px};
    cv::circle(window->picture, place_of(window, place_px), 1 << SUBPIXEL_BITS, colour_of(ink),
               cv::FILLED, cv::LINE_8, SUBPIXEL_BITS);
    return static_cast<int>(PLACIDO_OK);
  });
}

void placido_window_line(placido_window *window, const double from_px[2], const double to_px[2],
                         placido_window_ink ink) {
  guarded(nullptr, [&] {
    cv::line(window->picture, place_of(window, from_px), place_of(window, to_px), colour_of(ink), 1,
             cv::LINE_AA, SUBPIXEL_BITS);
    return static_cast<int>(PLACIDO_OK);
  });
}

void placido_window_box(placido_window *window, const double corner_px[2], double width_px,
                        double height_px, placido_window_ink ink) {
  guarded(nullptr, [&] {
    const double far_px[2] = {corner_px[0] + width_px, corner_px[1] + height_px};
    cv::rectangle(window->picture, place_of(window, corner_px), place_of(window, far_px),
                  colour_of(ink), cv::FILLED, cv::LINE_8, SUBPIXEL_BITS);
    return static_cast<int>(PLACIDO_OK);
  });
}

void placido_window_text(placido_window *window, const double place_px[2], double height_px,
                         const char *text, placido_window_ink ink) {
  guarded(nullptr, [&] {
    const double capital = 21; // of this font at scale 1
    const cv::Point place(cvRound(place_px[0] * window->scale),
                          cvRound(place_px[1] * window->scale));
    cv::putText(window->picture, text, place, cv::FONT_HERSHEY_SIMPLEX,
                height_px * window->scale / capital, colour_of(ink), height_px > 20 ? 2 : 1,
                cv::LINE_AA);
    return static_cast<int>(PLACIDO_OK);
  });
}

int placido_window_show(placido_window *window, int *key, placido_error *err) {
  *key = 0;
  return guarded(err, [&] {
    if (!window->picture.empty()) {
      cv::imshow(window->title, window->picture);
    }
    const int pressed = cv::waitKey(1);
    *key = pressed > 0 ? pressed & 255 : 0;
    const bool is_open = cv::getWindowProperty(window->title, cv::WND_PROP_VISIBLE) > 0;
    return is_open ? static_cast<int>(PLACIDO_OK)
                   : placido_error_set(err, PLACIDO_END, "the window was closed");
  });
}
