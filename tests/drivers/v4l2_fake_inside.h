/* What the two files of the scripted camera share. */
#ifndef PLACIDO_TESTS_DRIVERS_V4L2_FAKE_INSIDE_H
#define PLACIDO_TESTS_DRIVERS_V4L2_FAKE_INSIDE_H

#include "tests/drivers/v4l2_fake.h"

#define FAKE_FD_FIRST 100000 /* no descriptor of the process */

/* Sets errno and returns -1. */
int fake_fail(int code);
/* Counts a call; true where it is to fail. */
bool fake_must_fail(void);
bool fake_is_alive(int fd);
uint32_t fake_or_lie(uint32_t truth, uint32_t lie);

/* Requests that concern pictures, as ioctl. */
int fake_request_buffers(struct v4l2_requestbuffers *said);
int fake_query_buffer(struct v4l2_buffer *said);
int fake_queue(struct v4l2_buffer *said);
int fake_dequeue(struct v4l2_buffer *said);
int fake_stream(bool on);
int fake_export(struct v4l2_exportbuffer *said);

void *fake_mmap(void *address, size_t length, int protection, int flags, int fd, off_t offset);
int fake_munmap(void *address, size_t length);
int fake_poll(struct pollfd *files, nfds_t count, int timeout_ms);
ssize_t fake_read(int fd, void *bytes, size_t size);

#endif
