/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* An OpenCL layer (OPENCL_LAYERS=this library) that makes a device fail, without a change to the
 * program under test. It stands between the program and every driver.
 *
 *   PALPATE_FAULT_CALL    buffer: clCreateBuffer gives -4      kernel: launches give -5, from then on
 *                         build: clBuildProgram gives -11      read: reading gives -36, from then on
 *                         write: writing gives -5              source: clCreateProgramWithSource, -6
 *                         flip: a bit of a live buffer flips after that launch
 *                         hang: that launch takes ten minutes  crash: launches crash, from then
 *                                                              on
 *   PALPATE_FAULT_AT      at which call, from 1
 *   PALPATE_FAULT_SEED    which buffer, byte and bit flip
 *   PALPATE_FAULT_KERNELS file that gets the name of every kernel that was launched, a line each
 *   PALPATE_FAULT_REPORT  file that gets, at the end, "calls <n> fired <0 or 1> buffers <left over>"
 *
 * `palpate_live_objects` counts references to all objects that live now, for tests of leaks. */
#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl_layer.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static cl_icd_dispatch below, own;
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static long calls, fault_at, fired, live, live_buffers;
static char fault_call[16];

enum { most_buffers = 4096 };
static cl_mem buffers[most_buffers];
static size_t num_buffers;

__attribute__((visibility("default"))) long palpate_live_objects(void) { return live; }

static void count(long change, long of_buffers) {
    pthread_mutex_lock(&mutex);
    live += change;
    live_buffers += of_buffers;
    pthread_mutex_unlock(&mutex);
}

/* Whether this call is the one that fails; `from_then_on`: or any later one. */
static int fails(const char *call, int from_then_on) {
    if (strcmp(call, fault_call) != 0) return 0;
    pthread_mutex_lock(&mutex);
    ++calls;
    const int now = fault_at > 0 && (calls == fault_at || (from_then_on && calls > fault_at));
    if (now) fired = 1;
    pthread_mutex_unlock(&mutex);
    return now;
}

static void remember(cl_mem buffer) {
    pthread_mutex_lock(&mutex);
    if (num_buffers < most_buffers) buffers[num_buffers++] = buffer;
    pthread_mutex_unlock(&mutex);
}

static void forget(cl_mem buffer) {
    pthread_mutex_lock(&mutex);
    for (size_t i = 0; i < num_buffers; ++i)
        if (buffers[i] == buffer) {
            buffers[i] = buffers[--num_buffers];
            break;
        }
    pthread_mutex_unlock(&mutex);
}

/* ---- Faults -------------------------------------------------------------------------------- */

static cl_mem CL_API_CALL create_buffer(cl_context context, cl_mem_flags flags, size_t size,
                                        void *host, cl_int *status) {
    if (fails("buffer", 0)) {
        if (status) *status = CL_MEM_OBJECT_ALLOCATION_FAILURE;
        return NULL;
    }
    cl_mem made = below.clCreateBuffer(context, flags, size, host, status);
    if (made) {
        count(1, 1);
        remember(made);
    }
    return made;
}

static void flip_a_bit(cl_command_queue queue) {
    static unsigned long long state;
    const char *seed = getenv("PALPATE_FAULT_SEED");
    state = (seed ? strtoull(seed, NULL, 10) : 1) * 6364136223846793005ull + 1442695040888963407ull;
    const unsigned long long draws[3] = {state >> 33, (state * 2862933555777941757ull) >> 33,
                                         (state * 3202034522624059733ull) >> 33};
    pthread_mutex_lock(&mutex);
    cl_mem chosen = num_buffers ? buffers[draws[0] % num_buffers] : NULL;
    pthread_mutex_unlock(&mutex);
    size_t size = 0;
    if (!chosen || below.clGetMemObjectInfo(chosen, CL_MEM_SIZE, sizeof size, &size, NULL)) return;
    unsigned char byte = 0;
    below.clEnqueueReadBuffer(queue, chosen, CL_TRUE, draws[1] % size, 1, &byte, 0, NULL, NULL);
    byte ^= (unsigned char)(1u << draws[2] % 8);
    below.clEnqueueWriteBuffer(queue, chosen, CL_TRUE, draws[1] % size, 1, &byte, 0, NULL, NULL);
}

static void note_launch(cl_kernel kernel) {
    const char *path = getenv("PALPATE_FAULT_KERNELS");
    char name[128] = "";
    FILE *file = path ? fopen(path, "a") : NULL;
    if (!file) return;
    below.clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL);
    fprintf(file, "%s\n", name);
    fclose(file);
}

static cl_int CL_API_CALL enqueue_kernel(cl_command_queue queue, cl_kernel kernel,
                                         cl_uint dimensions, const size_t *offset,
                                         const size_t *global, const size_t *local, cl_uint waits,
                                         const cl_event *list, cl_event *event) {
    if (fails("kernel", 1)) return CL_OUT_OF_RESOURCES;
    if (fails("hang", 0)) sleep(600);
    if (fails("crash", 1)) raise(SIGSEGV);
    note_launch(kernel);
    const cl_int status = below.clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global,
                                                       local, waits, list, event);
    if (status == CL_SUCCESS && fails("flip", 0)) flip_a_bit(queue);
    return status;
}

static cl_int CL_API_CALL build_program(cl_program program, cl_uint devices,
                                        const cl_device_id *list, const char *options,
                                        void(CL_CALLBACK *notify)(cl_program, void *), void *user) {
    if (fails("build", 0)) return CL_BUILD_PROGRAM_FAILURE;
    return below.clBuildProgram(program, devices, list, options, notify, user);
}

static cl_int CL_API_CALL read_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                                      size_t offset, size_t size, void *to, cl_uint waits,
                                      const cl_event *list, cl_event *event) {
    if (fails("read", 1)) return CL_INVALID_COMMAND_QUEUE;
    return below.clEnqueueReadBuffer(queue, buffer, blocking, offset, size, to, waits, list, event);
}

static cl_int CL_API_CALL write_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                                       size_t offset, size_t size, const void *from, cl_uint waits,
                                       const cl_event *list, cl_event *event) {
    if (fails("write", 1)) return CL_OUT_OF_RESOURCES;
    return below.clEnqueueWriteBuffer(queue, buffer, blocking, offset, size, from, waits, list,
                                      event);
}

static cl_program CL_API_CALL create_program(cl_context context, cl_uint parts, const char **texts,
                                             const size_t *sizes, cl_int *status) {
    if (fails("source", 0)) {
        if (status) *status = CL_OUT_OF_HOST_MEMORY;
        return NULL;
    }
    cl_program made = below.clCreateProgramWithSource(context, parts, texts, sizes, status);
    if (made) count(1, 0);
    return made;
}

/* ---- Counting what lives ------------------------------------------------------------------- */

static cl_program CL_API_CALL create_program_from_binary(cl_context context, cl_uint devices,
                                                         const cl_device_id *list,
                                                         const size_t *sizes,
                                                         const unsigned char **binaries,
                                                         cl_int *each, cl_int *status) {
    cl_program made = below.clCreateProgramWithBinary(context, devices, list, sizes, binaries, each,
                                                      status);
    if (made) count(1, 0);
    return made;
}

static cl_kernel CL_API_CALL create_kernel(cl_program program, const char *name, cl_int *status) {
    cl_kernel made = below.clCreateKernel(program, name, status);
    if (made) count(1, 0);
    return made;
}

static cl_context CL_API_CALL create_context(const cl_context_properties *properties,
                                             cl_uint devices, const cl_device_id *list,
                                             void(CL_CALLBACK *notify)(const char *, const void *,
                                                                       size_t, void *),
                                             void *user, cl_int *status) {
    cl_context made = below.clCreateContext(properties, devices, list, notify, user, status);
    if (made) count(1, 0);
    return made;
}

static cl_command_queue CL_API_CALL create_queue(cl_context context, cl_device_id device,
                                                 cl_command_queue_properties properties,
                                                 cl_int *status) {
    cl_command_queue made = below.clCreateCommandQueue(context, device, properties, status);
    if (made) count(1, 0);
    return made;
}

#define COUNTED(type, argument, of_buffers)                                        \
    static cl_int CL_API_CALL retain_##type(argument object) {                     \
        const cl_int status = below.clRetain##type(object);                        \
        if (status == CL_SUCCESS) count(1, of_buffers);                            \
        return status;                                                             \
    }                                                                              \
    static cl_int CL_API_CALL release_##type(argument object) {                    \
        if (of_buffers) {                                                          \
            cl_uint left = 0;                                                      \
            below.clGetMemObjectInfo((cl_mem)(void *)object, CL_MEM_REFERENCE_COUNT, \
                                     sizeof left, &left, NULL);                    \
            if (left == 1) forget((cl_mem)(void *)object);                         \
        }                                                                          \
        const cl_int status = below.clRelease##type(object);                       \
        if (status == CL_SUCCESS) count(-1, -(of_buffers));                        \
        return status;                                                             \
    }
COUNTED(MemObject, cl_mem, 1)
COUNTED(Program, cl_program, 0)
COUNTED(Kernel, cl_kernel, 0)
COUNTED(Context, cl_context, 0)
COUNTED(CommandQueue, cl_command_queue, 0)

__attribute__((destructor)) static void report(void) {
    const char *path = getenv("PALPATE_FAULT_REPORT");
    FILE *file = path ? fopen(path, "w") : NULL;
    if (!file) return;
    fprintf(file, "calls %ld fired %ld buffers %ld\n", calls, fired, live_buffers);
    fclose(file);
}

/* ---- What the loader asks for -------------------------------------------------------------- */

CL_API_ENTRY cl_int CL_API_CALL clGetLayerInfo(cl_layer_info name, size_t size, void *value,
                                               size_t *size_needed) {
    static const cl_layer_api_version version = CL_LAYER_API_VERSION_100;
    static const char text[] = "palpate faults";
    const void *from = name == CL_LAYER_API_VERSION ? (const void *)&version : (const void *)text;
    const size_t needed = name == CL_LAYER_API_VERSION ? sizeof version : sizeof text;
    if (name != CL_LAYER_API_VERSION && name != CL_LAYER_NAME) return CL_INVALID_VALUE;
    if (value && size < needed) return CL_INVALID_VALUE;
    if (value) memcpy(value, from, needed);
    if (size_needed) *size_needed = needed;
    return CL_SUCCESS;
}

CL_API_ENTRY cl_int CL_API_CALL clInitLayer(cl_uint entries, const cl_icd_dispatch *target,
                                            cl_uint *entries_needed,
                                            const cl_icd_dispatch **layer) {
    const cl_uint needed = sizeof own / sizeof(void *);
    if (!target || !layer || !entries_needed || entries < needed) return CL_INVALID_VALUE;
    const char *call = getenv("PALPATE_FAULT_CALL"), *at = getenv("PALPATE_FAULT_AT");
    if (call) strncpy(fault_call, call, sizeof fault_call - 1);
    if (at) fault_at = atol(at);
    below = own = *target;
    own.clCreateBuffer = create_buffer;
    own.clEnqueueNDRangeKernel = enqueue_kernel;
    own.clBuildProgram = build_program;
    own.clEnqueueReadBuffer = read_buffer;
    own.clEnqueueWriteBuffer = write_buffer;
    own.clCreateProgramWithSource = create_program;
    own.clCreateProgramWithBinary = create_program_from_binary;
    own.clCreateKernel = create_kernel;
    own.clCreateContext = create_context;
    own.clCreateCommandQueue = create_queue;
    own.clRetainMemObject = retain_MemObject;
    own.clReleaseMemObject = release_MemObject;
    own.clRetainProgram = retain_Program;
    own.clReleaseProgram = release_Program;
    own.clRetainKernel = retain_Kernel;
    own.clReleaseKernel = release_Kernel;
    own.clRetainContext = retain_Context;
    own.clReleaseContext = release_Context;
    own.clRetainCommandQueue = retain_CommandQueue;
    own.clReleaseCommandQueue = release_CommandQueue;
    *layer = &own;
    *entries_needed = needed;
    return CL_SUCCESS;
}
