/* Preloaded (LD_PRELOAD), it lets calls that change files fail: the n-th of the process, or that one and all after it,
 * as on a disk that is full. Counted are calls on files below FAIL_BELOW, standard output not among them.
 *
 *   FAIL_AT     n, from 1; 0 counts only
 *   FAIL_WITH   number of the error
 *   FAIL_ON     "once" or "ever"
 *   FAIL_COUNT  file that gets the number of calls as the process ends */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;

static int is_below(const char* path) {
  const char* folder = getenv("FAIL_BELOW");
  char full[PATH_MAX];
  if (folder == NULL) return 0;
  if (path[0] != '/') {
    if (getcwd(full, sizeof full / 2) == NULL) return 0;
    strcat(full, "/");
    strncat(full, path, sizeof full / 2 - 1);
    path = full;
  }
  return strncmp(path, folder, strlen(folder)) == 0;
}

static int is_open_below(int descriptor) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = '\0';
  return is_below(path);
}

/* Whether this call, which is on a file below the folder, is to fail. */
static int fails(void) {
  const char* at = getenv("FAIL_AT");
  const long n = at != NULL ? atol(at) : 0, call = atomic_fetch_add(&calls, 1) + 1;
  const char* on = getenv("FAIL_ON");
  if (n <= 0 || call < n || (call > n && (on == NULL || strcmp(on, "once") == 0))) return 0;
  errno = atoi(getenv("FAIL_WITH"));
  return 1;
}

__attribute__((destructor)) static void count(void) {
  const char* name = getenv("FAIL_COUNT");
  FILE* file = name != NULL ? fopen(name, "w") : NULL;
  if (file == NULL) return;
  fprintf(file, "%ld\n", atomic_load(&calls));
  fclose(file);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

#define OPENS(name)                                                 \
  int name(const char* path, int flags, ...) {                      \
    va_list more;                                                   \
    va_start(more, flags);                                          \
    const mode_t mode = flags & O_CREAT ? va_arg(more, mode_t) : 0; \
    va_end(more);                                                   \
    if (flags & O_CREAT && is_below(path) && fails()) return -1;    \
    return REAL(name)(path, flags, mode);                           \
  }
OPENS(open)
OPENS(open64)

ssize_t write(int descriptor, const void* bytes, size_t count) {
  return is_open_below(descriptor) && fails() ? -1 : REAL(write)(descriptor, bytes, count);
}
ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t place) {
  return is_open_below(descriptor) && fails() ? -1 : REAL(pwrite)(descriptor, bytes, count, place);
}
ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t place) {
  return is_open_below(descriptor) && fails() ? -1 : REAL(pwrite64)(descriptor, bytes, count, place);
}
ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  return is_open_below(descriptor) && fails() ? -1 : REAL(writev)(descriptor, parts, count);
}
/* On a full disk files can be renamed. */
int rename(const char* from, const char* to) {
  const char* on = getenv("FAIL_ON");
  const int may_fail = on != NULL && strcmp(on, "once") == 0;
  return may_fail && is_below(to) && fails() ? -1 : REAL(rename)(from, to);
}
int mkdir(const char* path, mode_t mode) {
  return is_below(path) && fails() ? -1 : REAL(mkdir)(path, mode);
}
int ftruncate(int descriptor, off_t length) {
  return is_open_below(descriptor) && fails() ? -1 : REAL(ftruncate)(descriptor, length);
}
