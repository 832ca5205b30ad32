/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/colour.h"
#include <math.h>

static double clamp_unit(double x)
{
	return x > 0.0 ? fmin(x, 1.0) : 0.0;
}

double srgb_encode(double linear)
{
	const double x = clamp_unit(linear);
	if (x <= 0.0031308)
		return 12.92 * x;
	return x < 1.0 ? 1.055 * pow(x, 1.0 / 2.4) - 0.055 : 1.0;
}

double srgb_decode(double encoded)
{
	const double x = clamp_unit(encoded);
	return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

/* XYZ of the primaries, rows X, Y, Z, to four digits as the standard gives them. */
static const double xyz_of_rgb[3][3] = {
	{0.4124, 0.3576, 0.1805},
	{0.2126, 0.7152, 0.0722},
	{0.0193, 0.1192, 0.9505},
};

double colour_luminance(const double rgb[3])
{
	return xyz_of_rgb[1][0] * rgb[0] + xyz_of_rgb[1][1] * rgb[1] + xyz_of_rgb[1][2] * rgb[2];
}

/* A component relative to that of white, on CIELAB's scale: the cube root, and its tangent near black. */
static double lab_scale(const double row[3], const double rgb[3])
{
	const double white = row[0] + row[1] + row[2];
	const double t = (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]) / white;
	const double delta = 6.0 / 29.0;
	return t > delta * delta * delta ? cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
}

void colour_lab(const double rgb[3], double lab[3])
{
	const double x = lab_scale(xyz_of_rgb[0], rgb);
	const double y = lab_scale(xyz_of_rgb[1], rgb);
	const double z = lab_scale(xyz_of_rgb[2], rgb);
	lab[0] = 116.0 * y - 16.0;
	lab[1] = 500.0 * (x - y);
	lab[2] = 200.0 * (y - z);
}

static double degrees(double radians)
{
	return radians * (180.0 / M_PI);
}

static double cos_deg(double angle)
{
	return cos(angle * (M_PI / 180.0));
}

/* Hue in degrees, [0, 360). */
static double hue(double a, double b)
{
	const double h = degrees(atan2(b, a));
	return h < 0.0 ? h + 360.0 : h;
}

/* c^7 / (c^7 + 25^7) under the root: what is added for the blue corner and for near-greys. */
static double seventh(double c)
{
	const double c7 = pow(c, 7.0);
	return sqrt(c7 / (c7 + pow(25.0, 7.0)));
}

double delta_e_2000(const double p[3], const double q[3])
{
	/* a* is stretched near grey. */
	const double G = 0.5 * (1.0 - seventh(0.5 * (hypot(p[1], p[2]) + hypot(q[1], q[2]))));
	const double a1 = (1.0 + G) * p[1], a2 = (1.0 + G) * q[1];
	const double c1 = hypot(a1, p[2]), c2 = hypot(a2, q[2]), c = 0.5 * (c1 + c2);
	const double h1 = hue(a1, p[2]), h2 = hue(a2, q[2]);
	/* The shorter way around, and the hue in its middle. A grey has no hue: the other's counts. */
	double turn = h2 - h1, h = 0.5 * (h1 + h2);
	if (c1 * c2 == 0.0) {
		turn = 0.0;
		h = h1 + h2;
	} else if (fabs(turn) > 180.0) {
		turn += turn > 0.0 ? -360.0 : 360.0;
		h += h < 180.0 ? 180.0 : -180.0;
	}
	const double l = 0.5 * (p[0] + q[0]) - 50.0;
	const double T = 1.0 - 0.17 * cos_deg(h - 30.0) + 0.24 * cos_deg(2.0 * h) + 0.32 * cos_deg(3.0 * h + 6.0) -
			 0.20 * cos_deg(4.0 * h - 63.0);
	const double S_L = 1.0 + 0.015 * l * l / sqrt(20.0 + l * l), S_C = 1.0 + 0.045 * c, S_H = 1.0 + 0.015 * c * T;
	const double blue = (h - 275.0) / 25.0;
	const double R = -2.0 * seventh(c) * sin(M_PI / 3.0 * exp(-blue * blue));
	const double dL = (q[0] - p[0]) / S_L, dC = (c2 - c1) / S_C;
	const double dH = 2.0 * sqrt(c1 * c2) * sin(turn * (0.5 * M_PI / 180.0)) / S_H;
	return sqrt(fmax(0.0, dL * dL + dC * dC + dH * dH + R * dC * dH));
}

/* Linear rgb of a colour given in CIELAB. */
static void rgb_of_lab(const double lab[3], double rgb[3])
{
	static const double rgb_of_xyz[3][3] = {
		{3.240625477320053, -1.537207972210319, -0.4986285986982479},
		{-0.9689307147293194, 1.875756060885241, 0.04151752384295394},
		{0.05571012044551061, -0.2040210505984867, 1.056995942254388},
	};
	const double f[3] = {(lab[0] + 16.0) / 116.0 + lab[1] / 500.0, (lab[0] + 16.0) / 116.0,
			     (lab[0] + 16.0) / 116.0 - lab[2] / 200.0};
	const double delta = 6.0 / 29.0;
	double xyz[3];
	for (int i = 0; i < 3; i++) {
		const double t = f[i] > delta ? f[i] * f[i] * f[i] : 3.0 * delta * delta * (f[i] - 4.0 / 29.0);
		xyz[i] = t * (xyz_of_rgb[i][0] + xyz_of_rgb[i][1] + xyz_of_rgb[i][2]);
	}
	for (int i = 0; i < 3; i++)
		rgb[i] = rgb_of_xyz[i][0] * xyz[0] + rgb_of_xyz[i][1] * xyz[1] + rgb_of_xyz[i][2] * xyz[2];
}

void false_colour(double t, double rgb[3])
{
	/* a* and b* at equal steps; all of it lies inside what sRGB can show. */
	static const double ab[][2] = {{4, -12}, {34, -44}, {54, -28}, {60, 16}, {44, 48}, {12, 62}, {-2, 12}};
	enum { STEPS = sizeof ab / sizeof *ab - 1 };
	const double x = clamp_unit(t), at = x * STEPS;
	const int i = at < STEPS ? (int)at : STEPS - 1;
	const double s = at - i;
	const double lab[3] = {5.0 + 90.0 * x, ab[i][0] + s * (ab[i + 1][0] - ab[i][0]),
			       ab[i][1] + s * (ab[i + 1][1] - ab[i][1])};
	rgb_of_lab(lab, rgb);
}
