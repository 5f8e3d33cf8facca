"""An empty CUDA program, where no compiler is needed: the driver begins, a context is made on the
device of the given number, the process ends. Without a number CUDA is left out: what Python takes."""
import ctypes
import sys


def call(cuda, name, *arguments):
    code = getattr(cuda, name)(*arguments)
    if code:
        sys.exit(f"{name}: error {code} of CUDA's driver")


def main(numbers):
    for number in numbers:
        cuda = ctypes.CDLL("libcuda.so.1")
        device, context = ctypes.c_int(), ctypes.c_void_p()
        call(cuda, "cuInit", 0)
        call(cuda, "cuDeviceGet", ctypes.byref(device), int(number))
        call(cuda, "cuDevicePrimaryCtxRetain", ctypes.byref(context), device)  # the runtime's
        call(cuda, "cuCtxSetCurrent", context)


main(sys.argv[1:])
