/* A child in a folder of its own, its output in a file: only what it leaves counts. */
#include "exchange/process.h"

#include "base/file.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define EXIT_NO_PROGRAM 127
#define SAID_MAX 65536

/* In the child; calls only what is allowed between fork and exec. */
static void become(char *const *arguments, const char *folder, const char *said) {
  int in = open("/dev/null", O_RDONLY), out = -1;
  if (in >= 0 && chdir(folder) == 0) {
    out = open(said, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  }
  if (out >= 0 && dup2(in, STDIN_FILENO) >= 0 && dup2(out, STDOUT_FILENO) >= 0 &&
      dup2(out, STDERR_FILENO) >= 0) {
    execvp(arguments[0], arguments);
    _exit(errno == ENOENT ? EXIT_NO_PROGRAM : 126);
  }
  _exit(126);
}

static int refuse(const char *program, const char *folder, const char *said, placido_error *err) {
  char path[PLACIDO_PATH_MAX], *text = NULL;
  size_t size;
  if (placido_path_join(path, folder, said, NULL) == PLACIDO_OK &&
      placido_file_read(&text, &size, path, SAID_MAX, NULL) == PLACIDO_OK) {
    text[strcspn(text, "\n")] = '\0';
  }
  int status = placido_error_set(err, PLACIDO_SYSTEM, "%s failed: %s", program,
                                 text && text[0] ? text : "it does not say why");
  placido_memory_free(text);
  return status;
}

int placido_process_run(const char *const *arguments, const char *folder, const char *said,
                        placido_error *err) {
  int ended;
  pid_t child = fork();
  if (child == 0) {
    /* execvp does not write to what it is given; only its type is older than const */
    become((char *const *)arguments, folder, said);
  }
  if (child < 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot start %s: %s", arguments[0],
                             strerror(errno));
  }
  while (waitpid(child, &ended, 0) < 0) {
    if (errno != EINTR) {
      return placido_error_set(err, PLACIDO_SYSTEM, "lost sight of %s: %s", arguments[0],
                               strerror(errno));
    }
  }
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == EXIT_NO_PROGRAM) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "%s is not installed", arguments[0]);
  }
  bool done = WIFEXITED(ended) && WEXITSTATUS(ended) == 0;
  return done ? PLACIDO_OK : refuse(arguments[0], folder, said, err);
}
