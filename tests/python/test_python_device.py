"""Images that stay where they were rendered. On a GPU with torch, CuPy or JAX, those that are there."""
import importlib
import unittest

from ptexp_package import TestCase, np, ptexp

SMALL = {"width": 96, "height": 64, "spp": 4}
GPUS = [device.name for device in ptexp.devices() if device.name.startswith("cuda")]


def library(name):
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


class OnTheCpu(TestCase):
    def test_it_is_the_same_memory(self):
        image = ptexp.render("cornell", device="cpu", on_device=True, **SMALL)
        expected = ptexp.render("cornell", device="cpu", **SMALL)
        self.assertEqual(tuple(image.__dlpack_device__()), (1, 0))
        self.assertTrue((np.from_dlpack(image) == expected.array).all())
        self.assertTrue(np.shares_memory(np.from_dlpack(image), image.array))
        self.assertFalse(hasattr(image, "__cuda_array_interface__"))

    def test_images_that_are_put_together_on_the_host(self):
        scene = ptexp.load("cornell", **SMALL)
        for options in ({"device": "cpu:2"}, {"device": "cpu", "checkpoint": self.folder / "c.exr"}):
            with self.subTest(options), self.assertRaisesRegex(ptexp.Error, "on_device: .*one GPU"):
                ptexp.render(scene, on_device=True, **options)
        self.assertEqual(ptexp.render(scene).shape, (64, 96, 3))  # goes on


@unittest.skipUnless(GPUS, "no GPU")
class OnTheGpu(TestCase):
    def setUp(self):
        super().setUp()
        self.scene = ptexp.load("cornell", device="cuda", **SMALL)

    def test_bits(self):
        for options in ({}, {"mode": "megakernel"}, {"crop": (5, 3, 40, 30)},
                        {"filter": ("mitchell", 2)}, {"integrator": "mlt", "chains": 64},
                        {"aov": ("depth", "albedo")}):
            with self.subTest(options):
                expected = ptexp.render(self.scene, **options)
                image = ptexp.render(self.scene, on_device=True, **options)
                self.assertEqual(tuple(image.__dlpack_device__()), (2, 0))
                self.assertEqual(image.shape, expected.shape)
                self.assert_same_bits(image, expected)
                for name in expected.aovs:
                    np.testing.assert_array_equal(image.aovs[name], expected.aovs[name])
                path, other = self.folder / "image.exr", self.folder / "expected.exr"
                image.save(path), expected.save(other)
                self.assertEqual(ptexp.compare(path, other).differing_pixels, 0)

    def test_other_libraries(self):
        expected = ptexp.render(self.scene).array
        ways = {"torch": lambda m, image: m.from_dlpack(image).cpu().numpy(),
                "cupy": lambda m, image: m.asnumpy(m.from_dlpack(image)),
                "jax.dlpack": lambda m, image: np.asarray(m.from_dlpack(image))}
        found = {name: library(name) for name in ways}
        if not any(found.values()):
            self.skipTest("none of torch, cupy, jax is installed")
        for name, module in found.items():
            if module:
                with self.subTest(name):
                    image = ptexp.render(self.scene, on_device=True)
                    np.testing.assert_array_equal(ways[name](module, image), expected)
        if found["cupy"]:  # by CUDA's array interface
            image = ptexp.render(self.scene, on_device=True)
            np.testing.assert_array_equal(found["cupy"].asnumpy(found["cupy"].asarray(image)), expected)

    def test_it_outlives_its_image_and_later_renders(self):
        torch = library("torch")
        if not torch:
            self.skipTest("torch is not installed")
        expected = ptexp.render(self.scene).array
        tensor = torch.from_dlpack(ptexp.render(self.scene, on_device=True))
        self.assertTrue(tensor.is_cuda)
        pointer = tensor.data_ptr()
        others = [ptexp.render(self.scene, on_device=True, seed=seed) for seed in (2, 3)]
        self.assertNotIn(pointer, [other.__cuda_array_interface__["data"][0] for other in others])
        self.scene = None
        np.testing.assert_array_equal(tensor.cpu().numpy(), expected)

    def test_it_is_memory_to_be_written(self):
        torch = library("torch")
        if not torch:
            self.skipTest("torch is not installed")
        image = ptexp.render(self.scene, on_device=True)
        torch.from_dlpack(image).fill_(0.25)
        torch.cuda.synchronize()
        self.assertTrue((image.array == 0.25).all())


if __name__ == "__main__":
    unittest.main()
