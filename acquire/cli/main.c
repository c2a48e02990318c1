/* The program `placido`: finds the subcommand in a table, runs it, and says how it ended. */
#include "acquire/cli/command.h"
#include "acquire/cli/figures.h"
#include "acquire/cli/record.h"
#include "base/temporary.h"

#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const struct command *const commands[] = {&command_exam, &command_reconstruct,
                                                 &command_simulate, &command_plan, &command_phantom,
                                                 &command_devices, &command_device_sim,
                                                 &command_live,
                                                 &command_session,
                                                 &command_record,
                                                 &command_import, &command_export,
                                                 &command_calibrate, &command_verify, &command_compare, &command_iso_check,
                                                 &command_study, &command_bench};
#define COMMAND_COUNT (sizeof commands / sizeof commands[0])

/* Exit codes; docs/man/placido.1 lists them. A status that is not here gives EXIT_SYSTEM. */
#define EXIT_SYSTEM 1
static const struct {
  int status, code;
} exit_codes[] = {
    {PLACIDO_OK, 0}, {STATUS_USAGE, 2}, {PLACIDO_INPUT, 3}, {PLACIDO_END, 3}, {PLACIDO_QUALITY, 4},
    {STATUS_INCOMPLETE, 5},
};

static int exit_code(int status) {
  for (size_t i = 0; i < sizeof exit_codes / sizeof exit_codes[0]; i++) {
    if (exit_codes[i].status == status) {
      return exit_codes[i].code;
    }
  }
  return EXIT_SYSTEM;
}

void say(const struct settings *settings, const char *format, ...) {
  if (settings->quiet || settings->json) {
    return;
  }
  va_list arguments;
  va_start(arguments, format);
  vprintf(format, arguments);
  va_end(arguments);
  putchar('\n');
}

static const struct command *find_command(const char *name) {
  for (size_t i = 0; i < COMMAND_COUNT; i++) {
    if (strcmp(commands[i]->name, name) == 0) {
      return commands[i];
    }
  }
  return NULL;
}

static void print_overview(void) {
  puts("placido - corneal topography and simulated vision from pictures of Placido mires\n\n"
       "usage: placido COMMAND [OPTION...]\n\ncommands");
  for (size_t i = 0; i < COMMAND_COUNT; i++) {
    printf("  %-12s %s\n", commands[i]->name, commands[i]->summary);
  }
  puts("  help         Explain a command: placido help exam.\n\n"
       "options\n"
       "  --version    Print the version and what this build can do.\n"
       "  --help       Print this help.\n\n"
       "examples\n"
       "  placido phantom --eye keratoconus --instrument cone24 -o eye.session\n"
       "  placido exam eye.session -o exam\n\n"
       "exit codes\n"
       "  0  done\n"
       "  1  the system refused (no such file, disk full, memory), or this build cannot do it\n"
       "  2  the command line is wrong\n"
       "  3  an input is not what its format says\n"
       "  4  measured, and not good enough to give an answer\n"
       "  5  recorded, but frames were dropped or are missing\n\n"
       "Not a medical device.");
}

static void print_help(const struct command *command) {
  printf("usage: placido %s %s\n\n%s\n", command->name, command->usage, command->summary);
  options_print(command->groups);
  if (command->list) {
    command->list();
  }
  printf("\nexamples\n%s", command->examples);
}

static void print_version(void) {
  const struct settings settings = settings_default();
  printf("%s\nfigures and report: %s\nthreads: %d\n", PROGRAM_VERSION,
         figures_available() ? "yes" : "no", settings_use_threads(&settings));
}

/* Whether what was written really left: a full disk shows only here. */
static int flush_output(placido_error *err) {
  if (fflush(stdout) != 0 || ferror(stdout)) {
    return placido_error_set(err, PLACIDO_SYSTEM, "standard output cannot be written");
  }
  return PLACIDO_OK;
}

static int check_required(const struct command *command, const struct settings *settings,
                          placido_error *err) {
  if (command->needs_verb && !settings->verb) {
    return placido_error_set(err, STATUS_USAGE, "%s is missing (placido help %s)",
                             command->needs_verb, command->name);
  }
  if (command->needs_word && !settings->input) {
    return placido_error_set(err, STATUS_USAGE, "%s is missing (placido help %s)",
                             command->needs_word, command->name);
  }
  if (command->needs_word && settings->input[0] == '\0') {
    return placido_error_set(err, STATUS_USAGE, "%s is empty", command->needs_word);
  }
  if (!command->needs_word && !command->may_have_word && settings->input) {
    return placido_error_set(err, STATUS_USAGE, "\"%s\" is not expected (placido help %s)",
                             settings->input, command->name);
  }
  if (command->needs_output && !settings->output) {
    return placido_error_set(err, STATUS_USAGE, "say where the result goes with -o");
  }
  return PLACIDO_OK;
}

/* The one object on stdout that --json promises, whatever happened. */
static void print_json(const struct command *command, json_t *result, size_t layout, int status,
                       const placido_error *err) {
  json_t *root = result ? result : json_object();
  json_object_set_new(root, "command", record_text(command->name));
  json_object_set_new(root, "exit_code", json_integer(exit_code(status)));
  if (status != PLACIDO_OK) {
    json_object_set_new(root, "error", record_text(err->text));
  }
  json_dumpf(root, stdout, layout | JSON_REAL_PRECISION(17));
  putchar('\n');
  json_decref(root);
}

static int run_parsed(const struct command *command, const struct settings *settings,
                      placido_error *err) {
  struct outcome outcome = {.interrupt = interrupt_start(command->name)};
  stages_start(&outcome.stages, command->name, !settings->quiet);
  const int status = command->run(settings, &outcome, err);
  stages_end(&outcome.stages);
  interrupt_stop(outcome.interrupt);
  placido_temporary_hide(err->text);
  for (size_t i = 0; i < outcome.notes.count && !settings->quiet; i++) {
    fprintf(stderr, "placido: warning: %s\n", outcome.notes.lines[i]);
  }
  if (settings->timing && !settings->json && status == PLACIDO_OK) {
    stages_print(&outcome.stages);
  }
  if (settings->json) {
    print_json(command, outcome.result, outcome.has_json_lines ? JSON_COMPACT : JSON_INDENT(1),
               status, err);
  } else {
    json_decref(outcome.result);
  }
  placido_notes_clear(&outcome.notes);
  return status;
}

static int run_command(const struct command *command, int argc, char **argv) {
  placido_error err = {0};
  struct settings settings = settings_default();
  if (command->needs_verb && argc > 1 && argv[1][0] != '-') {
    settings.verb = argv[1];
    argc--;
    argv++;
  }
  struct text_list *more = command->may_have_more ? &settings.more : NULL;
  int status =
      options_parse(&settings, &settings.input, more, command->groups, argc, argv, &err);
  if (status == PLACIDO_OK && settings.help) {
    print_help(command);
  } else {
    if (status == PLACIDO_OK) {
      status = check_required(command, &settings, &err);
    }
    if (status == PLACIDO_OK) {
      status = run_parsed(command, &settings, &err);
    } else if (settings.json) {
      print_json(command, NULL, JSON_INDENT(1), status, &err);
    }
  }
  const int flushed = flush_output(status == PLACIDO_OK ? &err : NULL);
  status = status == PLACIDO_OK ? flushed : status;
  if (status != PLACIDO_OK) {
    fprintf(stderr, "placido: %s: %s\n", command->name, err.text);
  }
  return exit_code(status);
}

/* The end of what runs no command: whether its text reached standard output, or why there is
 * none. */
static int end_without_command(int status, placido_error *err) {
  const int flushed = flush_output(status == PLACIDO_OK ? err : NULL);
  status = status == PLACIDO_OK ? flushed : status;
  if (status != PLACIDO_OK) {
    fprintf(stderr, "placido: %s\n", err->text);
  }
  return exit_code(status);
}

static int refuse_command(const char *name, placido_error *err) {
  return placido_error_set(err, STATUS_USAGE,
                           "there is no command \"%.100s\" (placido help lists them)", name);
}

static int help(int argc, char **argv, placido_error *err) {
  if (argc > 2) {
    return placido_error_set(err, STATUS_USAGE, "help explains one command: \"%.100s\" is one "
                             "too many", argv[2]);
  }
  if (argc < 2 || strcmp(argv[1], "help") == 0) {
    print_overview();
    return PLACIDO_OK;
  }
  const struct command *command = find_command(argv[1]);
  if (!command) {
    return refuse_command(argv[1], err);
  }
  print_help(command);
  return PLACIDO_OK;
}

/* A standard stream that the caller closed would be the next file to be opened: something that
 * cannot be written takes its place, so that what is printed is an error and harms no file. */
static void fill_standard_streams(void) {
  int descriptor;
  do {
    descriptor = open("/dev/null", O_RDONLY);
  } while (descriptor >= 0 && descriptor <= STDERR_FILENO);
  if (descriptor >= 0) {
    close(descriptor);
  }
}

int main(int argc, char **argv) {
  placido_error err = {0};
  fill_standard_streams();
  signal(SIGXFSZ, SIG_IGN); /* a file over the limit is then an error of its write */
  if (argc < 2) {
    print_overview();
    placido_error_set(&err, STATUS_USAGE, "a command is missing");
    return end_without_command(STATUS_USAGE, &err);
  }
  const char *name = argv[1];
  if (strcmp(name, "--version") == 0) {
    print_version();
    return end_without_command(PLACIDO_OK, &err);
  }
  if (strcmp(name, "help") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
    return end_without_command(help(argc - 1, argv + 1, &err), &err);
  }
  const struct command *command = find_command(name);
  return command ? run_command(command, argc - 1, argv + 1)
                 : end_without_command(refuse_command(name, &err), &err);
}
